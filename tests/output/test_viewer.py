"""The viewer in a real browser: what moves, what is picked, keys, sizes, and that nothing else is asked for."""

import json
import re

import numpy as np
import pytest

from faying.output import scene as scenes
from faying.output.scene.text import to_dict
from tests.helpers.boxes import stack
from tests.helpers.browser import opened, until
from tests.helpers.scenes import two_boxes

HOSTILE = '</script><script>window.hurt=1</script><img src=x onerror="window.hurt=2">'


@pytest.fixture(scope="module")
def result():
    return two_boxes()


@pytest.fixture(scope="module")
def address(result, tmp_path_factory):
    file = tmp_path_factory.mktemp("view") / "page.html"
    file.write_text(scenes.page(scenes.of_result(result)), encoding="utf-8")
    return file.as_uri()


@pytest.fixture
def view(browser, address):
    with opened(browser, address, reduced_motion="reduce") as page:
        until(page, "window.view")
        yield page


def shown(page):
    return page.evaluate("window.view.state")


@pytest.mark.parametrize("phase", [0, 90, 200])
def test_nodes_are_where_numpy_has_them(view, result, phase):
    """cos(phase) Re - sin(phase) Im, scaled so that the greatest motion is the amplitude times the size."""
    load, mode, amplitude = 1, 2, 0.1
    view.evaluate(f"window.view.show({{load:{load},mode:{mode},phase:{phase},amplitude:{amplitude},playing:false}})")
    real, imaginary = result.shapes[load, mode], result.shapes_imaginary[load, mode]
    peak = np.sqrt((real**2 + imaginary**2).sum(axis=1).max())
    size = np.linalg.norm(np.ptp(result.outline, axis=0))
    angle = np.radians(phase)
    moved = result.outline + amplitude * size / peak * (np.cos(angle) * real - np.sin(angle) * imaginary)
    for name in result.parts:
        got = view.evaluate(
            f"(() => {{ const p = window.view.positions({json.dumps(name)});"
            " return [Array.from(p.nodes), Array.from(p.positions)]; })()"
        )
        nodes, places = np.array(got[0]), np.array(got[1]).reshape(-1, 3)
        assert set(nodes) == set(result.triangles[result.part_of_triangle == result.parts.index(name)].ravel())
        np.testing.assert_allclose(places, moved[nodes], atol=1e-4 * amplitude * size)


def test_what_is_drawn_is_where_the_nodes_are(view, result):
    """The silhouette on the screen: pick, which draws with the same shader, finds faces at displaced nodes alone."""
    view.evaluate("window.view.look('-y')")
    view.evaluate("window.view.show({mode:0,phase:0,amplitude:0.2,playing:false,fixings:false})")
    top = np.argmax(result.outline[:, 2] - 10 * np.abs(result.outline[:, 0] - 0.01))
    answer = view.evaluate(
        f"""(() => {{ const v = window.view, found = v.positions("p0"), k = found.nodes.indexOf({top});
        const at = v.project([0, 1, 2].map((j) => found.positions[3 * k + j]));
        const rest = v.project({result.outline[top].tolist()});
        return [v.pick(at.x, at.y + 4), v.pick(at.x, at.y - 6), Math.abs(at.y - rest.y)]; }})()"""
    )
    assert answer[0]["part"] == "p0"
    assert answer[1] is None
    assert answer[2] > 20


def test_the_canvas_is_not_blank_and_colours_follow_the_field(view):
    count = (
        "(() => { const { data } = window.view.pixels(); const found = new Set(); let on = 0;"
        " for (let k = 0; k < data.length; k += 4) if (data[k + 3]) { on++;"
        " found.add((data[k] << 16) + (data[k + 1] << 8) + data[k + 2]); } return [on, found.size]; })()"
    )
    on, colours = view.evaluate(count)
    assert on > 10000
    assert colours > 100  # motion, shaded
    view.evaluate("window.view.show({field:'parts',mode:null,fixings:false})")
    assert view.evaluate(count)[1] < colours
    view.evaluate("window.view.show({field:'pressure'})")
    assert view.evaluate(count)[1] > 100
    assert "pressure [MPa]" in view.locator(".fv-bar").inner_text()


def test_a_click_picks_the_face_and_says_its_number_name_part_area_and_centre(view, result):
    view.evaluate("window.view.show({mode:null})")
    known = to_dict(scenes.of_result(result))["faces"]
    view.evaluate("window.view.look('corner')")
    box = view.locator("canvas").bounding_box()
    seen = 0
    for number, face in enumerate(known):
        back = view.evaluate("(() => { const b = window.view.eye.axes().back; return [b.x, b.y, b.z]; })()")
        if np.dot(back, face["normal"]) < 0.2 or face["name"] in ("p0.right", "p1.left", "p0.left", "p1.right"):
            continue
        at = view.evaluate(f"window.view.project({face['centre']})")
        view.mouse.click(box["x"] + at["x"] + 3, box["y"] + at["y"] + 3)
        said = view.locator(".fv-facts").inner_text()
        assert said.startswith(f"p{face['part']}, face {face['number']}")
        assert float(re.search(r"area ([\d.]+) mm²", said).group(1)) == pytest.approx(1e6 * face["area"], rel=1e-3)
        assert view.evaluate("window.view.selection") == number
        seen += 1
    assert seen >= 4
    view.mouse.click(box["x"] + 5, box["y"] + box["height"] / 2)
    assert view.locator(".fv-facts").inner_text() == ""


def test_a_map_is_read_where_it_is_clicked(view, result):
    """At the middle of the joint, seen square to it, and at a corner: what NumPy has on the map's corners there."""
    (joint,) = scenes.of_result(result).joints
    corners = result.outline[joint.map.parents].mean(axis=1)
    view.evaluate("window.view.show({mode:null,field:'pressure',load:1})")
    view.evaluate("window.view.joint('flange', {look:true})")
    for place in (corners.mean(axis=0), corners.mean(axis=0) + np.array([0, 0.0125, 0.01])):
        at = view.evaluate(f"window.view.project({place.tolist()})")
        found = view.evaluate(f"window.view.reading({at['x']}, {at['y']})")
        near = np.argmin(np.linalg.norm(corners - place, axis=1))
        assert found["joint"] == "flange"
        assert found["value"] == pytest.approx(joint.map.fields["pressure"][1, near], rel=1e-3)
        box = view.locator("canvas").bounding_box()
        view.mouse.click(box["x"] + at["x"], box["y"] + at["y"])
        assert "pressure here: " in view.locator(".fv-facts").inner_text()


def test_names_that_are_asked_for_and_do_not_exist_are_errors(view):
    for call in ("select('p0',99)", "hide('p9')", "show({colour:'red'})"):
        told = view.evaluate(f"(async () => window.view.{call})().then(() => '', (fault) => fault.message)")
        assert re.search(r"no (face|part|colour)", told)


def test_parts_can_be_hidden(view):
    view.evaluate("window.view.show({mode:null,fixings:false,names:false,outline:false})")
    at = view.evaluate("window.view.project([0.2, 0.025, 0.04])")
    pick = f"window.view.pick({at['x']},{at['y']})"
    assert view.evaluate(pick)["part"] == "p1"
    view.get_by_label("p1", exact=True).uncheck()
    assert view.evaluate(pick) is None
    view.evaluate("window.view.unhide('p1')")
    assert view.evaluate(pick)["part"] == "p1"


def test_everything_works_by_keyboard_alone(view):
    """Tab reaches every control, in their order; keys on the view turn, zoom, play and change the mode."""
    reached = []
    view.keyboard.press("Tab")
    for _ in range(60):
        now = view.evaluate(
            "(() => { const e = document.activeElement; return e === document.body ? '' :"
            " e.getAttribute('aria-label') || e.textContent || e.closest('label')?.textContent; })()"
        )
        if not now:
            break
        reached.append(now)
        view.keyboard.press("Tab")
    for wanted in ("Preload", "Mode", "Play", "Phase", "Amplitude", "Speed", "Colour", "p0", "p1", "Names", "Face"):
        assert wanted in reached
    view.locator("canvas").focus()
    before = view.evaluate("[window.view.eye.azimuth, window.view.eye.half]")
    view.keyboard.press("ArrowRight")
    view.keyboard.press("+")
    after = view.evaluate("[window.view.eye.azimuth, window.view.eye.half]")
    assert after[0] != before[0]
    assert after[1] < before[1]
    view.keyboard.press("n")
    assert shown(view)["mode"] == 1
    assert not shown(view)["playing"]  # less motion is wanted
    view.keyboard.press(" ")
    assert shown(view)["playing"]
    before = view.evaluate("window.view.draws")
    until(view, f"window.view.draws > {before + 3}")
    view.keyboard.press(" ")
    view.get_by_label("Face", exact=True).select_option("2")
    assert view.locator(".fv-facts").inner_text() != ""
    view.locator("canvas").focus()
    view.keyboard.press("Escape")
    assert view.locator(".fv-facts").inner_text() == ""


@pytest.mark.parametrize(
    ("width", "scale"),
    [pytest.param(1280, 1, marks=pytest.mark.slow), pytest.param(800, 1, marks=pytest.mark.slow), (640, 2), (400, 1)],
)
def test_nothing_is_cut_off_at_any_width(browser, address, width, scale):
    """640 CSS pixels at a scale of 2 is a window of 1280 at 200 % zoom."""
    with opened(browser, address, width=width, height=700, device_scale_factor=scale) as page:
        until(page, "window.view")
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        cut = page.evaluate(
            "[...document.querySelectorAll('.fv-panel :is(select,button,input,label,output)')].filter((e) => {"
            " const b = e.getBoundingClientRect();"
            " return b.width && (b.left < 0 || b.right > innerWidth + 1); }).length"
        )
        assert cut == 0
        canvas = page.locator("canvas").bounding_box()
        assert canvas["width"] >= 380
        assert canvas["height"] >= 300
        for over in (".fv-bar", ".fv-scale", ".fv-head"):
            box = page.locator(over).bounding_box()
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= canvas["x"] + canvas["width"] + 1
        boxes = [page.locator(over).bounding_box() for over in (".fv-bar", ".fv-scale")]
        left, right = sorted(boxes, key=lambda box: box["x"])
        assert left["x"] + left["width"] <= right["x"] or left["y"] + left["height"] <= right["y"]


def test_names_of_any_kind_are_text(browser, tmp_path):
    found = two_boxes(title=HOSTILE, names=(HOSTILE,), parts=(HOSTILE, "b"))
    (tmp_path / "a.html").write_text(scenes.page(scenes.of_result(found)), encoding="utf-8")
    with opened(browser, (tmp_path / "a.html").as_uri()) as page:
        until(page, "window.view")
        page.evaluate("window.view.show({names:true}), window.view.select(window.view.scene.parts[0].name, 2)")
        assert HOSTILE in page.locator(".fv-facts").inner_text()
        assert page.title() == HOSTILE
        assert page.evaluate("window.hurt") is None
        assert page.locator("img").count() == 0


def test_a_strict_policy_lets_the_served_viewer_work(browser):
    """As a server gives it: modules and styles of its own alone, no inline script or style, no evaluation."""
    policy = "default-src 'self'; style-src 'self'; img-src 'self'; object-src 'none'; base-uri 'none'"
    text = scenes.to_text(scenes.of_mesh(stack([1.0, 2.0], [2, 3])))
    start = (
        'import { mount } from "/assets/viewer.js";\n'
        'const scene = await (await fetch("/scene.json")).json();\n'
        "const onPick = (face) => { document.documentElement.dataset.picked = `${face.name} ${face.number}`; };\n"
        "const view = await mount(document.body, scene, { onPick });\n"
        'addEventListener("keydown", (event) => { if (event.key === "d") view.dispose(); });\n'
    )
    html = '<!doctype html><title>t</title><body><script type="module" src="/start.js"></script></body>'
    files = {
        "/": ("text/html", html),
        "/start.js": ("text/javascript", start),
        "/scene.json": ("application/json", text),
    }
    files |= {f"/assets/{name}": ("text/javascript", file.read_text()) for name, file in scenes.ASSETS.items()}

    def answer(route):
        kind, body = files.get(route.request.url.removeprefix("http://local.test"), ("text/plain", ""))
        route.fulfill(body=body, content_type=kind, headers={"Content-Security-Policy": policy})

    browser_context = browser.new_context()
    page = browser_context.new_page()
    faults = []
    page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda fault: faults.append(str(fault)))
    page.route("**/*", answer)
    page.goto("http://local.test/")
    page.get_by_label("Face", exact=True).select_option(label="2 p1.right")
    page.locator("html[data-picked='p1.right 2']").wait_for()
    page.locator("body").press("d")
    page.locator("canvas").wait_for(state="detached")
    assert [text for text in faults if "favicon" not in text] == []
    browser_context.close()


@pytest.mark.slow
def test_a_large_mesh_turns_without_a_second_between_frames(browser, tmp_path):
    """300,000 triangles by the software renderer; the bound is loose, the frame takes a fraction of it."""
    n = 274
    x = np.linspace(0, 0.2, n)
    grid = np.stack(np.meshgrid(x, x, indexing="ij"), -1).reshape(-1, 2)
    sheets = [np.column_stack([grid, 0.01 * np.sin(40 * grid[:, 0]) + z]) for z in (0.0, 0.05)]
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    one = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    triangles = np.concatenate([one, one + n * n])
    points = np.concatenate(sheets)
    part = np.repeat([0, 1], len(one))
    found = two_boxes(
        outline=points,
        triangles=triangles,
        part_of_triangle=part,
        face_of_triangle=np.full(len(part), -1),
        shapes=np.tile(0.1 * np.sin(points), (2, 3, 1, 1)),
        shapes_imaginary=np.tile(0.1 * np.cos(points), (2, 3, 1, 1)),
        joint_faces=(("none", "none"),),
    )
    assert len(triangles) > 298e3
    (tmp_path / "a.html").write_text(scenes.page(scenes.of_result(found)), encoding="utf-8")
    with opened(browser, (tmp_path / "a.html").as_uri()) as page:
        until(page, "window.view")
        frames = page.evaluate(
            """async () => { const v = window.view, gl = v.renderer.getContext(), out = [];
            await v.show({ playing: false });
            for (let k = 0; k < 5; k++) { const begin = performance.now(); v.eye.turn(0.1, 0); v.draw();
              gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
              out.push(performance.now() - begin); }
            return out; }"""
        )
        assert min(frames) < 1000  # of a machine that others use, too
