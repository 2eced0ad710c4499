"""Self-contained HTML files of a prediction and of an identification: tables, figures, what a reader ought to know."""

from collections.abc import Sequence
from html import escape

from faying.errors import InputError
from faying.identify.identification import Identification
from faying.identify.prediction import LEVELS, Prediction
from faying.notes import Note
from faying.output import page, prediction
from faying.units import load_text

MEANS = (
    "If the listed numbers scatter as stated and the model is right, nine of ten such structures are inside 5 % to "
    "95 %. What is not listed is not in it: the error of the mesh, a wrong dimension, a law that is wrong in its shape."
)
TELLS = (
    "An interval of a number is that of the model's number: where the model lacks something that the structure has, "
    "another number may take its place. Intervals of frequencies are those of a test: model, its error and scatter."
)


def predicted(found: Prediction) -> str:
    """Return a prediction as the text of an HTML file."""
    from faying.identify import prediction as drawing

    rows, words = prediction.blame(found)
    inside, count = found.covered
    low, middle, high = LEVELS
    levels = f"{low:.0%} .. {'median' if middle == 0.5 else format(middle, '.0%')} .. {high:.0%}"
    tables = [
        ("What scatters", prediction.scatter(found), ""),
        (f"Frequencies, {levels}", prediction.intervals(found), MEANS),
        (f"Loss factors, {levels}", prediction.losses(found), ""),
        (f"Change with preload, {levels}", prediction.slopes(found), ""),
        (
            "Beside the test",
            prediction.beside_test(found),
            f"{inside} of {count} measured frequencies inside. {found.test_source}",
        ),
        (f"What makes the scatter at {load_text(found.loads[-1])}", rows, words),
    ]
    body = [
        f"<h1>{escape(found.title)}: prediction</h1>",
        f'<p class="soft">{found.answered} of {len(found.values)} samples have an answer.</p>',
        *_notes(found.notes),
    ]
    for title, lines, below in tables:
        if lines:
            body += [f"<h2>{escape(title)}</h2>", page.table(lines), f"<p>{escape(below)}</p>" if below else ""]
    body.append("<h2>Figures</h2>")
    for name, draw in (("intervals", drawing.intervals), ("shares", drawing.tornado)):
        try:
            body.append(f"<figure>{page.picture(name, draw(found))}</figure>")
        except InputError as fault:  # too few samples for shares of the variance
            body.append(f"<p>{escape(str(fault))}</p>")
    return page.document(f"{found.title}: prediction", "".join(body))


def identified(found: Identification, title: str, source: str) -> str:
    """Return an identification as the text of an HTML file; title: of its study; source: of its test."""
    from faying.identify import identification as drawing

    body = [
        f"<h1>{escape(title)}: identification</h1>",
        f'<p class="soft">{escape(source)}</p>',
        *_notes(found.notes),
        f"<pre>{escape(found.table())}</pre>",
        f"<p>{escape(TELLS)}</p>",
        f"<figure>{page.picture('identification', drawing.figure(found))}</figure>",
    ]
    return page.document(f"{title}: identification", "".join(body))


def _notes(notes: Sequence[Note]) -> list[str]:
    return ["<h2>Read this first</h2>", *(f'<p class="flag">{escape(n.text)}</p>' for n in notes)] if notes else []
