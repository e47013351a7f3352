from __future__ import annotations

import configparser
from pathlib import Path

from mart.platform.run.plan import (
    PlatformOptions,
    environment,
    lockstep_processes,
    processes,
    room,
    training_processes,
)
from mart.platform.run.supervisor import configuration
from mart.protocol.messages import RoomsRequest
from mart.protocol.vocabulary import ServiceKind


def test_the_router_comes_first_and_the_pages_last() -> None:
    kinds = [process.kind for process in processes(PlatformOptions(Path("data")))]
    assert kinds[0] == "router"
    assert kinds[-1] == "web"
    assert len(set(kinds)) == len(kinds)


def test_options_reach_the_commands() -> None:
    plan = processes(
        PlatformOptions(Path("data"), room="lab", task="t", control_hz=30.0, seed=7, public_host="lab.local")
    )
    words = {process.kind: " ".join(process.command) for process in plan}
    assert words[ServiceKind.SIM] == "sim --room lab --task t --control-hz 30 --seed 7"
    left = processes(PlatformOptions(Path("data"), room="lab", task="t", control_hz=None))
    assert [" ".join(one.command) for one in left if one.kind == ServiceKind.SIM] == [
        "sim --room lab --task t --control-hz auto"
    ]
    real = processes(PlatformOptions(Path("data"), task="t", drivers=("arm0", "arm1")))
    assert real[1].command[-4:] == ("--driver", "arm0", "--driver", "arm1")
    practice = processes(PlatformOptions(Path("data"), room="lab", task="t", practice=True))
    assert practice[1].command[-1] == "--practice"
    wanted = RoomsRequest.Open(room="room-2", task="t", course_required=True)
    assert room(PlatformOptions(Path("data"), practice=True, drivers=("arm0",)), wanted).command == (
        *("sim", "--room", "room-2", "--task", "t", "--control-hz", "auto", "--course-required"),
    )
    assert words[ServiceKind.WEB] == "web --host 127.0.0.1 --port 8443 --public-host lab.local"


def test_in_lockstep_there_are_rooms_and_who_saves_and_nobody_who_looks() -> None:
    options = PlatformOptions(
        Path("data"), room="collect-1", task="t", seed=7, skill="novice", time_limit_s=12.5
    )
    plan = lockstep_processes(options, rooms=2)
    assert sorted(process.kind for process in plan) == ["recorder", "replica", "router", "sim", "sim"]
    sims = [" ".join(process.command) for process in plan if process.kind == "sim"]
    assert sims == [
        f"sim --room collect-{number} --task t --control-hz 20 --seed 7 --skill novice --time-limit-s 12.5 --lockstep"
        for number in (1, 2)
    ]


def test_nothing_listens_beyond_the_loopback_unless_asked() -> None:
    options = PlatformOptions(Path("data"))
    assert options.host == "127.0.0.1"
    assert environment(options)["MART_ROUTER"] == "tcp/127.0.0.1:7447"


def test_the_supervisor_reads_back_what_was_planned_also_from_odd_folders(tmp_path: Path) -> None:
    options = PlatformOptions(tmp_path / 'a 100% "odd" folder')
    parser = configparser.ConfigParser(inline_comment_prefixes=(";",))
    parser.read_string(configuration(options, enumerate(processes(options)), tmp_path / "socket"))
    programs = [section for section in parser.sections() if section.startswith("program:")]
    assert [section.removeprefix("program:") for section in programs] == [
        process.name for process in processes(options)
    ]
    for number, section in enumerate(programs):
        assert parser.getint(section, "priority") == number
        assert parser.getboolean(section, "autorestart")
        assert "100%" in parser.get(section, "stdout_logfile")


def test_nobody_waits_for_what_learns_and_a_plain_session_goes_without() -> None:
    options = PlatformOptions(Path("data"))
    assert all(process.awaited for process in processes(options))
    plan = training_processes(options)
    assert {process.kind for process in plan if not process.awaited} == {"trainer", "policies"}
    assert [process for process in plan if process.awaited] == list(processes(options))
    assert plan[-1].kind == "web"
