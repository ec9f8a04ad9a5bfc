"""Files are written whole or not at all."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isotorque.symbolic.common.errors import InputError
from isotorque.symbolic.common.files import output_directory, write_whole


@given(st.text(max_size=50), st.binary(max_size=50))
@settings(max_examples=20)
def test_a_reader_keeps_the_file_that_it_opened(tmp_path_factory, text, content):
    """What replaces a file is another one: nobody who reads sees half of it."""
    path = tmp_path_factory.mktemp("files") / "file"
    write_whole(path, text)
    with path.open("rb") as reader:
        write_whole(path, content)
        assert reader.read() == text.encode()
    assert path.read_bytes() == content
    assert list(path.parent.iterdir()) == [path]
    assert path.stat().st_mode & 0o777 == 0o644


def test_a_file_that_cannot_be_written_leaves_nothing_and_the_one_before(tmp_path):
    path = tmp_path / "file"
    write_whole(path, "before")
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "\ud800")  # half a character
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]
    folder = tmp_path / "folder"
    folder.mkdir()
    with pytest.raises(InputError, match="a path that can be written"):
        write_whole(folder, "text")
    assert sorted(tmp_path.iterdir()) == [path, folder]
    with pytest.raises(InputError, match="a path that can be written"):
        write_whole(tmp_path / "none" / "file", "text")


def test_a_directory_is_made_or_refused(tmp_path):
    assert output_directory(tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="a directory to write to"):
        output_directory(tmp_path / "file" / "b")
