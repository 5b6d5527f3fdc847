"""The pages say what is so: their examples run, their outputs have the words that are shown, the site builds."""

import importlib.util
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TUTORIAL = ROOT / "docs" / "tutorial.md"
PAGES = [page for page in [*sorted((ROOT / "docs").glob("*.md")), ROOT / "README.md"] if page.exists()]
BLOCK = re.compile(r'^```(?P<kind>[\w+]+)(?: title="(?P<title>[^"]+)")?\n(?P<text>.*?)^```$', re.MULTILINE | re.DOTALL)
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT / "solver"), "NO_MKDOCS_2_WARNING": "1"}
MISSING_SYSTEM_LIBRARY = 3


@pytest.fixture
def folder(tmp_path):
    """What a page takes for the root of the sources; what it writes does not land there."""
    for name in ("meshes", "cases"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "t_handle.step").symlink_to(ROOT / "meshes" / "t_handle.step")
    return tmp_path


def pages_with_python():
    return [page for page in PAGES if page != TUTORIAL and blocks_of(page, "python")]


def blocks_of(page, kind):
    return [block["text"] for block in BLOCK.finditer(page.read_text(encoding="utf-8")) if block["kind"] == kind]


def run_python(text, folder):
    return subprocess.run(
        [sys.executable, "-c", text], cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, check=False
    )


def run_command(line, folder):
    words = re.sub(r"^rbfem\b", f'"{sys.executable}" -m rbfem', line)
    return subprocess.run(
        words, shell=True, cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, encoding="utf-8", check=False
    )


def commands_of(text):
    """(command, output shown below it) of a console block."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        line, _, shown = part.partition("\n")
        yield line, shown


def without_numbers(text):
    """Numbers depend on the version of gmsh and on the clock; where lines break depends on the numbers."""
    return " ".join(re.sub(r"-?\d[\d.]*(e[+-]?\d+)?", "#", text).split())


def missing_pieces(shown, printed):
    """The pieces between "…" of a shown output that were not printed."""
    printed = without_numbers(printed)
    return [piece for piece in shown.split("…") if without_numbers(piece) not in printed]


@pytest.mark.parametrize("page", pages_with_python(), ids=lambda page: page.name)
def test_the_python_of_a_page_runs(page, folder):
    done = run_python("\n".join(blocks_of(page, "python")), folder)
    assert done.returncode == 0, done.stderr


def test_the_tutorial_runs_as_written_and_prints_what_it_shows(folder):
    python = shown_by_python = ""
    for block in BLOCK.finditer(TUTORIAL.read_text(encoding="utf-8")):
        if block["title"]:
            (folder / block["title"]).write_text(block["text"], encoding="utf-8")
        elif block["kind"] == "console":
            for line, shown in commands_of(block["text"]):
                done = run_command(line, folder)
                if done.returncode == MISSING_SYSTEM_LIBRARY:
                    pytest.skip(done.stderr)
                is_refusal = shown.startswith("rbfem: ")
                assert done.returncode == (2 if is_refusal else 0), f"{line}\n{done.stderr}"
                assert missing_pieces(shown, done.stdout + done.stderr) == [], f"{line}\n{done.stdout}{done.stderr}"
        elif block["kind"] == "python":
            python += block["text"]
        elif block["kind"] == "text":
            shown_by_python += block["text"]
    done = run_python(python, folder)
    assert done.returncode == 0, done.stderr
    assert missing_pieces(shown_by_python, done.stdout) == []


def test_every_command_of_the_other_pages_runs(folder):
    pages = [page for page in PAGES if page.parent == TUTORIAL.parent and page != TUTORIAL]
    lines = [line for page in pages for text in blocks_of(page, "console") for line, _ in commands_of(text)]
    failed = {line: done.stderr for line in lines if (done := run_command(line, folder)).returncode}
    assert lines and failed == {}


def test_the_site_builds_without_warnings_and_needs_no_network(tmp_path):
    pytest.importorskip("mkdocs")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    pages = list(tmp_path.glob("*.html"))
    assert {"index.html", "case_file.html", "python.html"} <= {page.name for page in pages}
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert re.findall(r'(?:src|<link[^>]*href)="https?://[^"]*', text) == [], page.name
        assert str(ROOT) not in text
    assert not list(tmp_path.glob("*.py"))


def test_the_page_on_motion_has_the_costs_of_the_plan_and_every_method_of_the_table():
    from rbfem.motion.methods import METHODS

    spec = importlib.util.spec_from_file_location("hooks", ROOT / "docs" / "hooks.py")
    hooks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(hooks)
    page = hooks.on_page_markdown((ROOT / "docs" / "motion.md").read_text(encoding="utf-8"))
    assert hooks.plan_costs() in page
    for name, row in METHODS.items():
        order, count = hooks._order(row.order), hooks._count(row)
        assert re.search(rf"^\| `{name}` \| .* \| {order} \| .* \| {count} \|", page, re.MULTILINE)


def test_the_changelog_has_a_reason_for_every_dependency():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    names = [re.match(r"[\w.-]+", requirement).group() for requirement in project["dependencies"]]
    assert names == re.findall(r"^\| ([\w.-]+) \| .+ \|$", text, re.MULTILINE)
