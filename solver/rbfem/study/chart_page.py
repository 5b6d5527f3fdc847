"""The chart as one HTML page that needs nothing else: the drawing, what the pointer is over, and the table."""

import json
from html import escape

from rbfem.study.summary import HEAD, notes, rows, step_words
from rbfem.study.work_precision import Point, WorkPrecision

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff; max-width: 1300px; margin: 1.5rem auto;
  padding: 0 1rem; }
figure { margin: 0; position: relative; }
svg { width: 100%; height: auto; display: block; }
.near { stroke: #000; stroke-width: 3; paint-order: stroke; }
.dim { opacity: 0.12; }
#told { position: absolute; pointer-events: none; background: #fff; border: 1px solid #999; border-radius: 6px;
  box-shadow: 0 2px 8px #0003; padding: .5rem .8rem; font-size: 14px; white-space: nowrap; visibility: hidden; }
#told b { display: block; }
#told td { padding: 0 .8em 0 0; }
table.summary { border-collapse: collapse; margin: 1rem 0; }
.summary td, .summary th { padding: .15rem 1rem .15rem 0; text-align: right; border-bottom: 1px solid #e4e4e4; }
.summary td:first-child, .summary th:first-child { text-align: left; }
li { margin: .2rem 0; }
"""

# The pointer takes the nearest run within 30 pixels; its twin in the other panel is marked and other methods fade.
SCRIPT = """
const figure = document.querySelector("figure"), told = document.getElementById("told");
const labels = ["method", "step", "error", "seconds", "evaluations", "stable?"];
const marks = [];
runs.forEach((run, index) => ["seconds", "evaluations"].forEach(cost => {
  const mark = document.getElementById("run-" + index + "-" + cost);
  if (mark) marks.push({mark, run, index});
}));
function nearest(event) {
  let best = null, least = 30 * 30;
  for (const one of marks) {
    const box = one.mark.getBoundingClientRect();
    const dx = box.left + box.width / 2 - event.clientX, dy = box.top + box.height / 2 - event.clientY;
    if (dx * dx + dy * dy < least) { least = dx * dx + dy * dy; best = one; }
  }
  return best;
}
function show(event) {
  const best = nearest(event);
  for (const one of marks) {
    one.mark.classList.toggle("near", best !== null && one.index === best.index);
    one.mark.classList.toggle("dim", best !== null && one.run[0] !== best.run[0]);
  }
  told.style.visibility = best ? "visible" : "hidden";
  if (!best) return;
  const table = document.createElement("table");
  best.run.forEach((text, row) => {
    const line = table.insertRow();
    line.insertCell().textContent = labels[row];
    line.insertCell().textContent = text;
  });
  told.replaceChildren(table);
  const frame = figure.getBoundingClientRect(), x = event.clientX - frame.left, y = event.clientY - frame.top;
  told.style.left = (x + told.offsetWidth + 24 > frame.width ? x - told.offsetWidth - 16 : x + 16) + "px";
  told.style.top = Math.max(0, y - told.offsetHeight - 12) + "px";
}
figure.addEventListener("mousemove", show);
figure.addEventListener("mouseleave", () => show({clientX: -1e9, clientY: -1e9}));
"""


def page(study: WorkPrecision, drawing: str) -> str:
    """The HTML text. drawing : the SVG of `rbfem.study.chart.as_svg`, in which every run has its `run_id`."""
    title = escape(study.title or study.case)
    runs = [run_words(point) for point in study.points] + [run_words(study.chosen, "the plan's own: ")]
    head = "".join(f"<th>{escape(word)}</th>" for word in HEAD)
    body = "\n".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows(study))
    listed = "\n".join(f"<li>{escape(f'{label}: {text}')}</li>" for label, text in notes(study))
    return f"""<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><title>{title}: error against cost</title><style>{STYLE}</style></head>
<body>
<figure>
{drawing[drawing.index("<svg") :]}
<div id="told"></div>
</figure>
<p>The run of each method that keeps the accuracy of {study.accuracy:g} with the fewest evaluations:</p>
<table class="summary">
<tr>{head}</tr>
{body}
</table>
<ul>
{listed}
</ul>
<script>
const runs = {_script_data(runs)};
{SCRIPT}</script>
</body>
</html>
"""


def run_words(point: Point, before: str = "") -> list[str]:
    """What the pointer tells of a run: method, step, error, seconds, evaluations, whether it is stable.

    >>> run_words(Point("rk4", 0.01, None, 100, 400, 0.0125, 3.21e-7, True))
    ['rk4', '0.01 s', '3.21e-07', '0.0125', '400', 'yes']
    """
    stable = "yes" if point.is_stable else "no"
    error = f"{point.error:.3g}"
    return [
        before + point.method,
        f"{step_words(point)} s",
        error,
        f"{point.seconds:.3g}",
        f"{point.evaluations}",
        stable,
    ]


def _script_data(runs: list[list[str]]) -> str:
    """JSON that cannot end the script element it stands in."""
    return json.dumps(runs, ensure_ascii=False, indent=0).replace("<", "\\u003c")
