"""Values as TOML: what is written is read again, numbers of NumPy included."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.toml_text import inline

VALUES = st.recursive(
    st.booleans() | st.integers(-(2**62), 2**62) | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)


@given(VALUES)
def test_what_is_written_in_a_line_is_read_again(value) -> None:
    text = inline(value)
    assert "\n" not in text
    assert tomllib.loads(f"it = {text}\n") == {"it": value}


def test_numbers_of_numpy_are_numbers() -> None:
    assert inline([np.float64(0.5), *np.array([1e-7, -2.0])]) == "[0.5, 1e-07, -2.0]"


def test_what_toml_has_no_word_for_is_refused() -> None:
    with pytest.raises(TypeError, match="object"):
        inline(object())
