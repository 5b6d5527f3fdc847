import json

from click.testing import CliRunner

from rbfem.case.schema import json_schema
from rbfem.cli.schema import command


def objects(schema):
    """The case and every section below it."""
    return [schema, *schema["$defs"].values()]


def test_every_key_of_the_json_schema_has_a_description():
    for section in objects(json_schema()):
        for key, node in section["properties"].items():
            assert node.get("description"), f"{section['title']}.{key}"


def test_every_section_refuses_unknown_keys():
    assert all(section["additionalProperties"] is False for section in objects(json_schema()))


def test_a_number_may_be_a_string_and_says_its_unit():
    radius = json_schema()["$defs"]["Sphere"]["properties"]["radius"]
    assert radius["type"] == ["number", "string"]
    assert radius["exclusiveMinimum"] == 0
    assert radius["description"] == "Radius. SI unit: m."
    step = json_schema()["$defs"]["Time"]["properties"]["step"]
    assert step["description"].endswith("SI unit: s.")


def test_no_private_mark_is_left_in_the_json_schema():
    assert "x-unit" not in json.dumps(json_schema())


def test_the_command_prints_the_json_schema():
    result = CliRunner().invoke(command)
    assert result.exit_code == 0
    assert json.loads(result.output) == json_schema()
