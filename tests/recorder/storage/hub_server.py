"""A hub on this machine: the small part of its HTTP interface that pushing a data set takes, for one account."""

from __future__ import annotations

import base64
import hashlib
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from flask import Flask, Response, jsonify, request
from werkzeug.serving import make_server

TOKEN = "hf_aVerySecretTokenOfAna"
LFS_SUFFIXES = (".mp4", ".parquet", ".hdf5")
_ONE = "/api/datasets/<owner>/<name>"


@dataclass
class Repo:
    private: bool
    files: dict[str, bytes] = field(default_factory=lambda: {".gitattributes": b"*.mp4 filter=lfs\n"})
    tags: list[str] = field(default_factory=list)
    commits: list[str] = field(default_factory=list)


@dataclass
class Hub:
    """Hold data sets by OWNER/NAME, and objects that came and no commit names yet, by SHA-256."""

    endpoint: str = ""
    repos: dict[str, Repo] = field(default_factory=dict)
    objects: dict[str, bytes] = field(default_factory=dict)
    excuse: str = ""  # for which it does nothing

    def app(self) -> Flask:
        app = Flask("hub")
        app.before_request(self._guard)
        app.post("/api/repos/create")(self.create)
        app.post("/api/validate-yaml")(lambda: jsonify(errors=[], warnings=[]))
        app.get(f"{_ONE}/tree/main")(self.tree)
        app.post(f"{_ONE}/preupload/main")(self.preupload)
        app.post(f"{_ONE}/commit/main")(self.commit)
        app.post(f"{_ONE}/tag/main")(self.tag)
        app.delete(f"{_ONE}/tag/<tag>")(self.untag)
        app.post("/datasets/<owner>/<name>.git/info/lfs/objects/batch")(self.batch)
        app.put("/objects/<oid>")(self.put)
        return app

    def _guard(self) -> Response | None:
        if self.excuse:
            return Response("{}", 400, {"X-Error-Message": self.excuse})
        if request.path.startswith("/objects/") or request.headers.get("Authorization") == f"Bearer {TOKEN}":
            return None
        return Response(json.dumps({"error": "Invalid username or password."}), 401)

    def create(self) -> tuple[Any, int]:
        asked = request.get_json()
        repo = f"{asked['organization']}/{asked['name']}"
        known = repo in self.repos
        if not known:
            self.repos[repo] = Repo(asked.get("visibility") == "private" or asked.get("private") is True)
        return jsonify(url=f"{self.endpoint}/datasets/{repo}"), 409 if known else 200

    def tree(self, owner: str, name: str) -> Response:
        repo = self.repos.get(f"{owner}/{name}")
        if repo is None:
            return Response("{}", 404, {"X-Error-Code": "RepoNotFound"})
        return jsonify([_entry(path, data) for path, data in repo.files.items()])

    def preupload(self, owner: str, name: str) -> Response:
        modes = [
            {
                "path": one["path"],
                "uploadMode": "lfs" if one["path"].endswith(LFS_SUFFIXES) else "regular",
                "shouldIgnore": False,
            }
            for one in request.get_json()["files"]
        ]
        return jsonify(files=modes)

    def batch(self, owner: str, name: str) -> Response:
        objects = [
            {**one, "actions": {"upload": {"href": f"{self.endpoint}/objects/{one['oid']}"}}}
            for one in request.get_json()["objects"]
        ]
        return jsonify(transfer="basic", objects=objects)

    def put(self, oid: str) -> str:
        data = request.get_data()
        assert hashlib.sha256(data).hexdigest() == oid
        self.objects[oid] = data
        return ""

    def commit(self, owner: str, name: str) -> Response:
        repo = self.repos[f"{owner}/{name}"]
        for line in map(json.loads, request.get_data().splitlines()):
            value = line["value"]
            if line["key"] == "header":
                repo.commits.append(value["summary"])
            elif line["key"] == "deletedFile":
                del repo.files[value["path"]]
            elif line["key"] == "lfsFile":
                repo.files[value["path"]] = self.objects[value["oid"]]
            else:
                repo.files[value["path"]] = base64.b64decode(value["content"])
        oid = f"{len(repo.commits):040x}"
        return jsonify(commitOid=oid, commitUrl=f"{self.endpoint}/datasets/{owner}/{name}/commit/{oid}")

    def tag(self, owner: str, name: str) -> Response:
        self.repos[f"{owner}/{name}"].tags.append(request.get_json()["tag"])
        return jsonify({})

    def untag(self, owner: str, name: str, tag: str) -> Response:
        tags = self.repos[f"{owner}/{name}"].tags
        if tag not in tags:
            return Response("{}", 404, {"X-Error-Code": "RevisionNotFound"})
        tags.remove(tag)
        return jsonify({})


def _entry(path: str, data: bytes) -> dict[str, Any]:
    blob = hashlib.sha1(b"blob %d\0" % len(data) + data, usedforsecurity=False).hexdigest()
    entry: dict[str, Any] = {"type": "file", "path": path, "size": len(data), "oid": blob}
    if path.endswith(LFS_SUFFIXES):
        lfs = {"oid": hashlib.sha256(data).hexdigest(), "size": len(data), "pointerSize": 130}
        entry |= {"lfs": lfs}
    return entry


@contextmanager
def running_hub() -> Iterator[Hub]:
    """Serve a hub on a port of its own."""
    hub = Hub()
    server = make_server("127.0.0.1", 0, hub.app(), threaded=True)
    hub.endpoint = f"http://127.0.0.1:{server.server_port}"
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield hub
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
