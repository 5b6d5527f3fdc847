import re

from rbfem.case.reader import read_case
from rbfem.case.reference import reference_page
from rbfem.case.schema import Case, json_schema


def test_every_key_is_on_the_page():
    page = reference_page()
    for section in [json_schema(), *json_schema()["$defs"].values()]:
        for key in section["properties"]:
            assert f"| `{key}` |" in page, key


def test_a_row_tells_meaning_unit_and_default():
    page = reference_page()
    assert "| `radius` | Radius. | m | required |" in page
    assert '| `step` | Step of the method, or `auto`: chosen by the plan. | s | `"auto"` |' in page
    assert "| `pivot` | World point where a ball joint holds it: it can only turn about it. | m |  |" in page


def test_the_rows_of_every_table_have_four_columns():
    page = reference_page()
    for table in re.findall(r"\| key \|.*?\n\n", page, re.DOTALL):
        assert {len(re.findall(r"(?<!\\)\|", row)) for row in table.strip().splitlines()} == {5}


def test_the_example_on_the_page_is_a_valid_case(tmp_path):
    example = re.search(r"```yaml\n(.*?)```", reference_page(), re.DOTALL)
    (tmp_path / "case.yaml").write_text(example.group(1))
    case = read_case(tmp_path)
    assert set(Case.model_fields) == case.model_fields_set, "the example shows every key of the top level"
