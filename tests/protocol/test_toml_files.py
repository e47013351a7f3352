"""Files in which people describe what is theirs: each mistake is told with what the file is and where it is."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import BaseModel, ConfigDict

from mart.protocol.errors import InvalidInput, NotFound
from mart.protocol.toml_files import FileSort, is_name, names_in

SORT = FileSort("cup file", "`mart cups` lists them", "how-to-bring-your-own-cup", most_bytes=1024)


class Cup(BaseModel):
    model_config = ConfigDict(extra="forbid")

    name: str
    sizes_m: list[float]


def cup(path: Path) -> Cup:
    said = SORT.table(SORT.read(path), str(path))
    return SORT.checked(Cup, {**said, "name": path.stem}, str(path))


def test_it_is_called_as_its_file_is(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("sizes_m = [0.1]")
    (tmp_path / "No Name.toml").touch()
    assert cup(tmp_path / "mine.toml") == Cup(name="mine", sizes_m=[0.1])
    assert names_in(tmp_path) == {"mine"}
    assert not is_name("../mine")


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("My Cup.toml", b"", "cannot be the name of a file that is a cup file"),
        ("mine.txt", b"", "small letters, digits and underscores, then .toml"),
        ("mine.toml", b"#" * 1025, "is larger than 1 KiB; a cup file holds text alone"),
        ("mine.toml", b"\xff", "is not text"),
        ("mine.toml", b"sizes_m =", "is not TOML"),
        ("mine.toml", b"name = 'x'", "says a name"),
        ("mine.toml", b"", "sizes_m: Field required"),
        ("mine.toml", b"sizes_m = [0.1, 'x']", r"sizes_m[2]: "),
        (
            "mine.toml",
            b"size_m = [0.1]",
            "size_m: there is no such key; leave it out, or look for its name in how-to",
        ),
    ],
)
def test_each_mistake_is_a_sentence(tmp_path: Path, name: str, text: bytes, said: str) -> None:
    path = tmp_path / name
    path.write_bytes(text)
    with pytest.raises(InvalidInput) as refused:
        cup(path)
    assert said in str(refused.value)
    assert name in str(refused.value)
    assert str(refused.value).endswith(".")


def test_where_there_is_none_it_is_said_what_lists_them(tmp_path: Path) -> None:
    with pytest.raises(NotFound, match=r"There is no cup file .*`mart cups` lists them"):
        cup(tmp_path / "mine.toml")
