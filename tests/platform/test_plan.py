from __future__ import annotations

import configparser
from pathlib import Path

from mart.platform.plan import Options, environment, processes
from mart.platform.supervise import configuration


def test_the_router_comes_first_and_the_pages_last() -> None:
    kinds = [process.kind for process in processes(Options(Path("data")))]
    assert kinds[0] == "router"
    assert kinds[-1] == "web"
    assert len(set(kinds)) == len(kinds)


def test_options_reach_the_commands() -> None:
    plan = processes(
        Options(Path("data"), room="lab", task="t", control_hz=30.0, seed=7, public_host="lab.local")
    )
    words = {process.kind: " ".join(process.command) for process in plan}
    assert words["sim"] == "sim --room lab --task t --control-hz 30 --seed 7"
    assert words["web"] == "web --host 127.0.0.1 --port 8443 --public-host lab.local"


def test_nothing_listens_beyond_the_loopback_unless_asked() -> None:
    options = Options(Path("data"))
    assert options.host == "127.0.0.1"
    assert environment(options)["MART_ROUTER"] == "tcp/127.0.0.1:7447"


def test_the_supervisor_reads_back_what_was_planned_also_from_odd_folders(tmp_path: Path) -> None:
    options = Options(tmp_path / 'a 100% "odd" folder')
    parser = configparser.ConfigParser(inline_comment_prefixes=(";",))
    parser.read_string(configuration(options, processes(options)))
    programs = [section for section in parser.sections() if section.startswith("program:")]
    assert [section.removeprefix("program:") for section in programs] == [
        process.name for process in processes(options)
    ]
    for number, section in enumerate(programs):
        assert parser.getint(section, "priority") == number
        assert parser.getboolean(section, "autorestart")
        assert "100%" in parser.get(section, "stdout_logfile")
