"""Two runs never write to one folder at the same time."""

import pytest

from rbfem.errors import InputError
from rbfem.results.whole_file import FolderLock


def test_a_second_run_is_kept_out_while_the_first_writes_and_let_in_after(tmp_path):
    first = FolderLock(tmp_path)
    with pytest.raises(InputError, match="another run is writing to this folder; wait for it, or choose another"):
        FolderLock(tmp_path)
    first.release()
    first.release()
    FolderLock(tmp_path).release()
    assert list(tmp_path.iterdir()) == []
