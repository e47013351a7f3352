from __future__ import annotations

import gzip
import re

import pytest

from mart.web.api.pages import STATIC, site
from mart.web.api.static_site import StaticFile, StaticSite
from tests.web.conftest import Enter

PAGES = sorted(path.stem for path in STATIC.glob("*.html"))
_STRINGS = re.compile(r'["\'`](/static/[^"\'`]*)')


def made_of(**texts: str) -> StaticSite:
    """A site of files, "js/a.js" written js__a_js."""
    names = {name.replace("__", "/").replace("_", "."): text for name, text in texts.items()}
    return StaticSite({name: StaticFile(name, text.encode()) for name, text in names.items()})


def site_with(**modules: str) -> StaticSite:
    page = '<head>\n    <script type="module" src="/static/js/a.js"></script>\n  </head>'
    return made_of(x_html=page, **modules)


def test_all_modules_of_a_page_are_named_once() -> None:
    found = site_with(
        js__a_js=(
            'import { b } from "./b.js";\nimport {\n  c,\n} from "./sub/c.js";\n'
            '/** @import { T } from "./t.js" */\n'
        ),
        js__b_js='export { c } from "./sub/c.js";\nimport "./a.js";\nconst text = "./no.js";\n',
        js__sub__c_js='import * as b from "../b.js";\nimport("./later.js");\n',
    ).modules_of("x")
    assert found == ["js/a.js", "js/b.js", "js/sub/c.js"]


def test_a_page_names_its_version_and_its_modules() -> None:
    site = site_with(js__a_js='import "./b.js";\n', js__b_js="")
    page = site.page("x").content.decode()
    assert page.count("modulepreload") == 2
    assert f'<link rel="modulepreload" href="/static/{site.digest}/js/b.js" />' in page
    assert _STRINGS.findall(page.replace(f"/static/{site.digest}/", "")) == []


def test_another_content_has_another_digest() -> None:
    one, other = site_with(js__a_js="1;"), site_with(js__a_js="2;")
    assert one.digest != other.digest == site_with(js__a_js="2;").digest
    assert one.find(f"{one.digest}/js/a.js") == (one.files["js/a.js"], True)
    assert one.find(f"{other.digest}/js/a.js") == (one.files["js/a.js"], False)
    assert one.find("js/a.js") == (one.files["js/a.js"], False)
    assert one.find("other/js/a.js") is None


@pytest.mark.parametrize("page", PAGES)
def test_every_module_of_a_page_is_there(page: str) -> None:
    modules = site().modules_of(page)
    assert [module for module in modules if module not in site().files] == []
    assert len(modules) == len(set(modules))


def test_the_operators_page_preloads_its_whole_graph() -> None:
    modules = site().modules_of("operator")
    assert {"js/operator.js", "js/link/peer.js", "js/drive/quaternion.js"} <= set(modules)
    assert len(modules) > 25


def test_the_lobby_fetches_ahead_what_the_operators_page_needs() -> None:
    page = site().page("lobby").content.decode()
    ahead = set(re.findall(rf'rel="prefetch" href="/static/{site().digest}/([^"]+)"', page))
    assert {"js/operator.js", "css/hud.css"} <= ahead
    assert ahead & set(site().modules_of("lobby")) == set()


def test_scripts_and_styles_name_no_file_without_its_version() -> None:
    """A file that is addressed from its importer's own address stays below the digest."""
    named = {
        name: _STRINGS.findall(file.content.decode())
        for name, file in site().files.items()
        if name.endswith((".js", ".css"))
    }
    assert {name: found for name, found in named.items() if found} == {}


@pytest.mark.anyio
async def test_browsers_keep_what_a_page_names_and_ask_for_the_page(enter: Enter) -> None:
    browser = await enter()
    page = await browser.get("/rooms/room-1/arms/arm0")
    assert page.headers["cache-control"] == "no-cache"
    script = re.findall(r'<script type="module" src="([^"]+)"', page.text)[0]
    answer = await browser.get(script)
    assert "immutable" in answer.headers["cache-control"]
    assert answer.headers["content-type"].startswith("text/javascript")
    for other in (f"/static/{'0' * 16}/js/operator.js", "/static/js/operator.js"):
        old = await browser.get(other)
        assert (old.headers["cache-control"], old.text) == ("no-cache", answer.text)


@pytest.mark.anyio
async def test_texts_come_packed_where_that_is_understood(enter: Enter) -> None:
    browser = await enter()
    plain = await browser.get("/static/css/base.css", headers={"Accept-Encoding": "identity"})
    packed = await browser.get("/static/css/base.css", headers={"Accept-Encoding": "gzip"})
    assert "content-encoding" not in plain.headers
    assert packed.headers["content-encoding"] == "gzip"
    assert packed.headers["vary"] == plain.headers["vary"] == "Accept-Encoding"
    assert plain.content == packed.content == gzip.decompress(site().files["css/base.css"].packed or b"")
    assert int(packed.headers["content-length"]) < len(plain.content) / 2
