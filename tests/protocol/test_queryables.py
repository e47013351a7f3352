"""Every key has its message: what is added to the keys is checked, answered and fuzzed like the others."""

from __future__ import annotations

import inspect
from typing import get_type_hints

from mart.protocol import keys
from mart.protocol.keys import Topic
from mart.protocol.queryables import BROADCASTS, QUERYABLES

_ASKED_BY_A_WORD = {keys.model, keys.admission}


def test_every_topic_is_said_or_asked() -> None:
    topics = {
        function
        for name, function in inspect.getmembers(keys, inspect.isfunction)
        if not name.startswith("_")
        and get_type_hints(function).get("return") is Topic
        and "topic" not in get_type_hints(function)
    }
    said = {broadcast.topic for broadcast in BROADCASTS}
    asked = {queryable.topic for queryable in QUERYABLES}
    assert topics == said | asked | _ASKED_BY_A_WORD


def test_every_reply_can_say_what_went_wrong() -> None:
    for queryable in QUERYABLES:
        assert "error" in queryable.reply_type.DESCRIPTOR.fields_by_name
