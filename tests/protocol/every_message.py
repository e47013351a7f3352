"""Every message of the wire, found by its descriptor, with each of its fields set once: none can be forgotten."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass

import mart.v1

_SCALARS: dict[int, object] = {
    FieldDescriptor.CPPTYPE_DOUBLE: 0.75,
    FieldDescriptor.CPPTYPE_FLOAT: 0.75,
    FieldDescriptor.CPPTYPE_INT32: -5,
    FieldDescriptor.CPPTYPE_INT64: -5,
    FieldDescriptor.CPPTYPE_UINT32: 300,
    FieldDescriptor.CPPTYPE_UINT64: 1_700_000_000_000_000_000,
    FieldDescriptor.CPPTYPE_BOOL: True,
}


def kinds() -> dict[str, type[Message]]:
    """Return every message of the schemas, those inside others too, by its name below `mart.v1`."""
    found: dict[str, type[Message]] = {}
    for module in pkgutil.iter_modules(mart.v1.__path__):
        if module.name.endswith("_pb2"):
            file = importlib.import_module(f"mart.v1.{module.name}").DESCRIPTOR
            for descriptor in file.message_types_by_name.values():
                found |= {_name(one): GetMessageClass(one) for one in _with_inner(descriptor)}
    return found


def filled() -> dict[str, Message]:
    """Return each message with all its fields, by name; of one with alternatives, one for each: `Event.what=notice`.

    Messages inside are empty: they have an entry of their own.
    """
    return {name: message for kind, made in kinds().items() for name, message in _filled(kind, made)}


def _filled(name: str, kind: type[Message]) -> Iterator[tuple[str, Message]]:
    oneofs = {
        field.name for oneof in kind.DESCRIPTOR.oneofs for field in oneof.fields if len(oneof.fields) > 1
    }
    always = kind()
    for field in kind.DESCRIPTOR.fields:
        if field.name not in oneofs:
            _set(always, field)
    yield name, always
    for field in kind.DESCRIPTOR.fields:
        if field.name in oneofs:
            message = kind()
            _set(message, field)
            assert field.containing_oneof is not None
            yield f"{name}.{field.containing_oneof.name}={field.name}", message


def _set(message: Message, field: Any) -> None:
    target = getattr(message, field.name)
    if field.message_type is not None and field.message_type.GetOptions().map_entry:
        key, value = field.message_type.fields
        if value.message_type is None:
            target[_scalar(key)] = _scalar(value)
        else:
            target[_scalar(key)].SetInParent()
    elif field.message_type is not None:
        target.add() if field.is_repeated else target.SetInParent()
    elif field.is_repeated:
        target.append(_scalar(field))
    else:
        setattr(message, field.name, _scalar(field))


def _scalar(field: Any) -> object:
    if field.cpp_type == FieldDescriptor.CPPTYPE_ENUM:
        return field.enum_type.values[-1].number
    if field.type == FieldDescriptor.TYPE_BYTES:
        return b"\x01\x02"
    return field.name if field.type == FieldDescriptor.TYPE_STRING else _SCALARS[field.cpp_type]


def _with_inner(descriptor: Descriptor) -> Iterator[Descriptor]:
    yield descriptor
    for inner in descriptor.nested_types:
        if not inner.GetOptions().map_entry:
            yield from _with_inner(inner)


def _name(descriptor: Descriptor) -> str:
    return descriptor.full_name.removeprefix("mart.v1.")
