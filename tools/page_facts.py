"""Writes what the pages know from the Python parts into the files that they are made of: `make page-facts`.

Values go into a JavaScript module, the arms' colours into a style sheet, and the shapes of the protobuf messages that
the API sends as JSON into TypeScript declarations, which tsc holds the pages to.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import cast, get_args

from google.protobuf.descriptor import Descriptor, EnumDescriptor, FieldDescriptor
from google.protobuf.message import Message
from pydantic import BaseModel

from mart.platform.run.room_manager import MAX_EPISODES
from mart.protocol.control_rate import OFFERED_CONTROL_HZ
from mart.protocol.tasks import MAX_ARMS, Arm, get_task, task_names
from mart.trainer.models.architecture import PAPER, ModelSpec
from mart.trainer.train.presets import PRESETS
from mart.v1.catalogue_pb2 import CatalogueReply
from mart.v1.command_pb2 import Operator
from mart.v1.room_pb2 import BarrierPhase, Cue, EpisodePhase, Outcome
from mart.v1.trainer_pb2 import JobState, Policy, TrainerReply
from mart.web.api.episodes import LabelRequest
from mart.web.api.rooms import NewRoom
from mart.web.api.training import Submission

_WEB = Path(__file__).resolve().parents[1] / "services/web"
_STATIC = _WEB / "src/mart/web/static"
_MADE = "Made by `make page-facts` from the Python parts; do not edit."
_LONGEST_OBJECT = 80

_TASK_OF_FOUR_ARMS = "two_arm_multi_cube_lifting"
_AXES = ("planner", "actor", "residual")
_ENUMS = [enum.DESCRIPTOR for enum in (BarrierPhase, Cue, EpisodePhase, JobState, Operator, Outcome)]
_MESSAGES: tuple[type[Message], ...] = (
    CatalogueReply.Curated,
    CatalogueReply.Details,
    CatalogueReply.Edited,
    CatalogueReply.Listing,
    CatalogueReply.QualityComparison,
    CatalogueReply.QualityDetails,
    Policy,
    TrainerReply.Choices,
    TrainerReply.Details,
)


def files() -> dict[Path, str]:
    """Each file that is made, by its path, with the text that it must have."""
    return {
        _STATIC / "js/facts.js": _lines(_module()),
        _STATIC / "css/arms.css": _lines(_style_sheet()),
        _WEB / "types/messages.d.ts": _lines(_declarations()),
    }


def _module() -> Iterator[str]:
    yield f"// {_MADE}"
    for comment, name, value in _facts():
        yield ""
        yield f"/** {comment} */"
        yield f"export const {name} = {_constant(value)};"


def _facts() -> Iterator[tuple[str, str, object]]:
    """What each fact is, its name in JavaScript, and its value."""
    axes = {axis: get_args(ModelSpec.model_fields[axis].annotation) for axis in _AXES}
    yield "The arms that a task may have.", "ARMS", [arm.name for arm in _arms()]
    yield "The shape that stands for each arm.", "ARM_SYMBOLS", {arm.name: arm.symbol for arm in _arms()}
    titles = {task: get_task(task).title for task in task_names()}
    yield "The tasks as people call them.", "TASK_TITLES", titles
    yield "What partners can say by one press, in the order of the keys.", "CUES", _words(Cue.DESCRIPTOR)
    yield "ModelSpec architectures: who can plan, who can act, who can correct.", "MODEL_AXES", axes
    yield "The paper's models, in the order of its table.", "PAPER_MODELS", list(PAPER)
    yield "Sizes of a training, the smallest first.", "PRESETS", list(PRESETS)
    yield "Control rates that a room may have, ticks a second.", "CONTROL_RATES_HZ", list(OFFERED_CONTROL_HZ)
    yield "Good episodes that a room may plan at most.", "MAX_PLANNED_EPISODES", MAX_EPISODES
    yield "Characters of a name of a room, at most.", "MAX_NAME_LENGTH", _most(NewRoom, "room")
    yield "Characters of a note about an episode, at most.", "MAX_NOTE_LENGTH", _most(LabelRequest, "note")
    yield "Seeds of a training, at most.", "MAX_SEEDS", _most(Submission, "seeds")
    yield "Rollouts of a checkpoint, at most.", "MAX_ROLLOUTS", _most(Submission, "evaluation_episodes")


def _constant(value: object) -> str:
    """JavaScript source whose type is the value itself, not string or number."""
    if isinstance(value, int):
        return str(value)
    return f"/** @type {{const}} */ ({_source(value)})"


def _source(value: object) -> str:
    match value:
        case dict():
            inner = [f"{key}: {_source(one)}" for key, one in value.items()]
            whole = f"{{ {', '.join(inner)} }}"
            return whole if len(whole) < _LONGEST_OBJECT else "{\n  " + ",\n  ".join(inner) + ",\n}"
        case list() | tuple():
            return f"[{', '.join(map(_source, value))}]"
        case int() | float():
            return f"{value:g}"
    return json.dumps(value)


def _most(body: type[BaseModel], field: str) -> int:
    """The upper bound that a request's body sets for a field: its value, its length or its number of items."""
    bounds = body.model_fields[field].metadata
    found = (getattr(bound, name, None) for bound in bounds for name in ("max_length", "le"))
    return next(most for most in found if isinstance(most, int))


def _style_sheet() -> Iterator[str]:
    yield f"/* The arms' colours, and what can be read on them. {_MADE} */"
    for arm in _arms():
        ink = "#fff" if _luminance(arm.color) < _MIDDLE_LUMINANCE else "#000"
        yield f'[data-arm="{arm.name}"] {{ --arm: {arm.color.lower()}; --on-arm: {ink}; }}'


# White and black contrast alike with this: (1 + 0.05) / (x + 0.05) = (x + 0.05) / 0.05, WCAG 2.2.
_MIDDLE_LUMINANCE = (1.05 * 0.05) ** 0.5 - 0.05


def _luminance(color: str) -> float:
    """Relative luminance of an sRGB hex colour, 0 … 1 (WCAG 2.2)."""
    shares = (int(color[at : at + 2], 16) / 255 for at in (1, 3, 5))
    red, green, blue = (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in shares)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def _arms() -> tuple[Arm, ...]:
    return get_task(_TASK_OF_FOUR_ARMS, MAX_ARMS).arms


def _declarations() -> Iterator[str]:
    yield "// Protobuf messages as the API sends them (docs/protocol.md): 64-bit numbers as text, enums in one word."
    yield f"// {_MADE}"
    yield ""
    yield "declare namespace Messages {"
    for enum in _ENUMS:
        yield f"  type {enum.name} = {' | '.join(map(json.dumps, _words(enum)))};"
    for message in sorted(_reachable(_MESSAGES), key=_type_name):
        yield ""
        yield from (f"  {line}" for line in _interface(message))
    yield "}"


def _interface(message: Descriptor) -> Iterator[str]:
    yield f"interface {_type_name(message)} {{"
    for field in message.fields:
        absent = "?" if field.has_presence else ""
        yield f"  {field.name}{absent}: {_field_type(field)};"
    yield "}"


def _reachable(kinds: Iterable[type[Message]]) -> set[Descriptor]:
    """These and all that they hold, maps left out."""
    found: set[Descriptor] = set()
    left = [cast("Descriptor", kind.DESCRIPTOR) for kind in kinds]  # the stubs name two classes that are one
    while left:
        message = left.pop()
        if not _is_map(message):
            found.add(message)
        held = {field.message_type for field in message.fields if field.message_type is not None}
        left += held - found
    return found


def _field_type(field: FieldDescriptor) -> str:
    if field.message_type is not None and _is_map(field.message_type):
        key, value = (_value_type(field.message_type.fields_by_name[name]) for name in ("key", "value"))
        return f"Record<{key}, {value}>"
    return f"{_value_type(field)}[]" if field.is_repeated else _value_type(field)


def _value_type(field: FieldDescriptor) -> str:
    if field.message_type is not None:
        return _type_name(field.message_type)
    if field.enum_type is not None:
        return field.enum_type.name
    match field.cpp_type:
        case FieldDescriptor.CPPTYPE_BOOL:
            return "boolean"
        case FieldDescriptor.CPPTYPE_INT32 | FieldDescriptor.CPPTYPE_UINT32 | FieldDescriptor.CPPTYPE_DOUBLE:
            return "number"
        case _:
            return "string"  # texts, bytes in base64, 64-bit numbers


def _type_name(message: Descriptor) -> str:
    """A nested message carries the names of those around it: TrainerReplyChoices."""
    return message.full_name.removeprefix(message.file.package).replace(".", "")


def _is_map(message: Descriptor) -> bool:
    return message.GetOptions().map_entry


def _words(enum: EnumDescriptor) -> list[str]:
    """An enum's values as the API says them, without the first, which says nothing: OPERATOR_HUMAN is human."""
    nothing, *values = (value.name for value in enum.values)
    return [value.removeprefix(nothing.removesuffix("UNSPECIFIED")).lower() for value in values]


def _lines(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


if __name__ == "__main__":
    for path, text in files().items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
