"""The command `mart web`."""

from __future__ import annotations

import sys
from typing import Any

import click

from mart.protocol.vocabulary import ServiceKind
from mart.runtime.cli import json_option, print_result


@click.command()
@click.option("--host", "web_host", help="Address to listen at.  [default: 127.0.0.1, this computer alone]")
@click.option("--port", "web_port", type=click.IntRange(0, 65535), help="Port to listen at.  [default: 8443]")
@click.option("--public-host", help="Names or addresses that people and phones use, separated by commas.")
@json_option
def web(as_json: bool, **options: Any) -> None:
    """Serve the lobby and the operators' and phones' pages over HTTPS."""
    from mart.runtime.privacy import keep_private
    from mart.runtime.service import run_async
    from mart.web.access.join_code import load_or_make_host_code, load_or_make_join_code
    from mart.web.access.site_names import in_url
    from mart.web.app.server import listen, serve
    from mart.web.app.settings import WebSettings

    settings = WebSettings(**{name: value for name, value in options.items() if value is not None})
    keep_private(settings.data_dir)
    join_code = load_or_make_join_code(settings.join_code_path, settings.join_code)
    host_code = load_or_make_host_code(settings.host_code_path)
    with listen(settings.web_host, settings.web_port) as listener:
        port = listener.getsockname()[1]
        name = next(iter(settings.public_names), settings.web_host)
        url = f"https://{in_url(name)}:{port}/"
        # What a service prints ends up in a log, which more people read than should know the code.
        shown = join_code if sys.stdout.isatty() else f"in {settings.join_code_path}"
        print_result({"url": url, "join_code": join_code}, f"Lobby {url}  join code {shown}", as_json)
        run_async(
            settings,
            ServiceKind.WEB,
            "web",
            lambda service: serve(settings, service, listener, join_code, host_code),
        )
