"""The page in a browser: Chromium without a window moves its sliders, and its numbers are Python's."""

import base64
import re
import shutil
import subprocess

import numpy as np
import pytest
from sampled import some_points

import rom
from control.export.page import write
from rom.rod.compiled.evaluation import sections

webdriver = pytest.importorskip("selenium.webdriver", reason="needs selenium (the environment has it)")
pytestmark = pytest.mark.skipif(shutil.which("chromedriver") is None, reason="needs Chromium and its driver")
QUANTITIES = "tip", "contact_force", "touch_distance"
# As root, without a display, a graphics card and a network.
FLAGS = (
    *("--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--disable-dev-shm-usage"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update"),
)
# Arrays cross as text that keeps infinities and NaN.
ASK = """
const bytes = Uint8Array.from(atob(arguments[0]), (one) => one.charCodeAt(0));
const points = new Float64Array(bytes.buffer), p = arguments[1], found = [];
for (let i = 0; i < points.length; i += p) {
  const own = window.fingerfem.evaluate([...points.slice(i, i + p)]);
  const { tip, contact_force, touch_distance } = own.error;
  found.push(...own.tip, own.contact_force, own.touch_distance, tip, contact_force, touch_distance, own.inside ? 1 : 0);
}
let text = "";
for (const one of new Uint8Array(new Float64Array(found).buffer)) text += String.fromCharCode(one);
return btoa(text);
"""
SECTIONS = """
window.fingerfem.evaluate(arguments[0]);
const found = window.fingerfem.model.sections();
return found && [...found];
"""


def chromium(driver, method: str, **parameters) -> None:
    """Ask Chromium itself."""
    driver.execute("chromium", {"cmd": method, "params": parameters})


def emulated(driver, method: str, **parameters) -> None:
    """Have it take itself for another device."""
    chromium(driver, f"Emulation.{method}", **parameters)


MODELS = "rod", "table", pytest.param("two_segments", marks=pytest.mark.long)


@pytest.fixture(scope="module")
def driver():
    service = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, text=True)
    assert service.stdout is not None
    port = next(found[1] for line in service.stdout if (found := re.search(r"successfully on port (\d+)", line)))
    options = webdriver.ChromeOptions()
    for flag in FLAGS:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    found = webdriver.Remote(f"http://127.0.0.1:{port}", options=options)  # not localhost: the environment has no hosts
    found.set_script_timeout(1800)  # tests assert no seconds
    found.command_executor._commands["chromium"] = ("POST", "/session/$sessionId/goog/cdp/execute")
    yield found
    found.quit()
    service.terminate()
    service.wait()


@pytest.fixture(scope="module")
def opened(driver, tmp_path_factory, models):
    """Open the page of a model, once each."""
    from selenium.webdriver.support.ui import WebDriverWait

    folder, pages = tmp_path_factory.mktemp("pages"), {}

    def open_page(name):
        if name not in pages:
            pages[name] = folder / f"{name}.html"
            write(models[name], pages[name])
        driver.set_window_size(1280, 800)
        driver.get(pages[name].as_uri())
        WebDriverWait(driver, 600).until(lambda page: page.execute_script("return document.body.dataset.ready"))
        return driver

    return open_page


@pytest.fixture
def page(opened):
    return opened("rod")


def asked(driver, points: np.ndarray) -> np.ndarray:
    """Answers of the page, shape (m, 9)."""
    return np.vstack([asked_at_once(driver, points[k : k + 200]) for k in range(0, len(points), 200)])


def asked_at_once(driver, points: np.ndarray) -> np.ndarray:
    sent = base64.b64encode(np.ascontiguousarray(points, "<f8").tobytes()).decode()
    return np.frombuffer(base64.b64decode(driver.execute_script(ASK, sent, points.shape[1])), "<f8").reshape(-1, 9)


@pytest.mark.parametrize(
    "name", ["table", *(pytest.param(one, marks=pytest.mark.long) for one in ("rod", "two_segments"))]
)
def test_its_numbers_are_python_s_also_outside(opened, models, name):
    model = models[name]
    points = some_points(model, 2_000)
    found, expected = asked(opened(name), points), model.evaluate(points)
    sizes = np.array([0.05, 0.05, 0.05, 10.0, 0.05])
    want = np.column_stack([expected.tip, expected.contact_force, expected.touch_distance])
    errors = np.column_stack([expected.error[quantity] for quantity in QUANTITIES])
    solved, solved_by_page = np.isfinite(errors), np.isfinite(found[:, 5:8])
    alike = (found[:, 8].astype(bool) == expected.inside) & (solved == solved_by_page).all(axis=1)
    assert (~alike).sum() <= len(points) // 500  # rounding decides whether a solve near a limit point converges
    known = solved.all(axis=1) & alike  # without an equilibrium, the numbers are of the last iteration
    off = np.abs((found[:, :5] - want) / sizes)[known]
    assert np.quantile(off, 0.999) < 1e-9 and off.max() < 1e-6  # the few: all but unstable, to the solve's tolerance
    assert np.abs(found[known, 5:8] - errors[known]).max() < 1e-9
    assert known.sum() > 0.85 * len(points) and (known & ~expected.inside).sum() > 0.1 * len(points)
    assert 0 < expected.inside.sum() < len(points)


@pytest.mark.long
@pytest.mark.parametrize("name", MODELS)
def test_it_shows_orientation_and_shortenings_of_a_rod_alone(opened, models, name):
    model, shown = models[name], opened(name)
    assert shown.find_element("id", "reports").is_displayed() == (name != "table")
    if name == "table":
        return
    point = model.limits[0] + np.array([0.3, 0.1, 0.2]) * (model.limits[1] - model.limits[0])
    answer, report = (
        shown.execute_script("return window.fingerfem.evaluate(arguments[0])", point.tolist()),
        model.report(point),
    )
    assert answer["orientation"] == pytest.approx(report.orientation, abs=1e-9)
    assert answer["shortenings"] == pytest.approx(report.shortenings, abs=1e-11)
    assert answer["error"]["orientation"] == pytest.approx(float(report.orientation_error))
    assert answer["error"]["shortenings"] == pytest.approx(float(report.shortening_error))
    at = shown.execute_script("return window.fingerfem.point()")
    words = re.findall(r"F\d (-?[\d.]+)", shown.find_element("id", "shortenings").text)
    assert [float(word) for word in words] == pytest.approx(1e3 * model.report(at).shortenings, abs=6e-4)


@pytest.mark.parametrize("name", ["rod", pytest.param("two_segments", marks=pytest.mark.long)])
def test_the_shape_is_python_s(opened, models, name):
    model = models[name]
    shown = opened(name)
    lower, upper = model.limits
    for share in ([0.3, 0.2, 0.9], [0.7, 0.1, 0.2]):
        point = lower + share * (upper - lower)
        found = np.reshape(shown.execute_script(SECTIONS, point.tolist()), (-1, 4, 3))
        wrenches = model.answers(point).loads[0]
        expected = np.concatenate(sections(model.rod.struct, point[:-1], wrenches))
        assert np.abs(found - expected).max() < 1e-9


@pytest.mark.long
def test_pressures_have_sliders_and_their_chambers_grow(driver, chambered, tmp_path):
    from selenium.webdriver.support.ui import WebDriverWait

    from rom.rod.objects.shapes import facing_plane
    from rom.rod.touched_segment import TouchedSegment

    model = TouchedSegment(rod=chambered, obstacle=facing_plane(0.005, (0.0, 0.02)))
    write(model, tmp_path / "chambered.html")
    driver.get((tmp_path / "chambered.html").as_uri())
    WebDriverWait(driver, 600).until(lambda page: page.execute_script("return document.body.dataset.ready"))
    highest = model.limits[1][1]
    typed(driver, "d", "20")
    typed(driver, "p1", f"{highest / 2e3}")
    at = driver.execute_script("return window.fingerfem.point()")
    assert at[1] == pytest.approx(highest / 2)
    expected = model.report(at)
    assert expected.inside
    words = re.findall(r"p\d (-?[\d.]+)", driver.find_element("id", "growths").text)
    assert [float(word) for word in words] == pytest.approx(1e9 * expected.growths, abs=6e-4)
    assert float(words[0]) > 0.1
    assert driver.find_element("id", "shortenings").text.startswith("F1 ")


def number(driver, name: str) -> float:
    """Number of a reading."""
    return float(driver.find_element("id", name).text.split("±")[0])


def moved(driver, name: str, key: str, times: int) -> None:
    """Press a key on a slider, as a person does, and wait until the page has followed."""
    before = driver.execute_script("return window.fingerfem.frames.drawn")
    driver.find_element("id", name).send_keys(key * times)
    from selenium.webdriver.support.ui import WebDriverWait

    WebDriverWait(driver, 600).until(lambda page: page.execute_script("return window.fingerfem.frames.drawn") > before)
    driver.execute_script("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def test_sliders_bend_the_finger_and_the_readings_follow(page):
    from selenium.webdriver.common.keys import Keys

    model, before = rom.load(), page.get_screenshot_as_png()
    moved(page, "pull-0", Keys.ARROW_RIGHT, 60)
    moved(page, "d", Keys.ARROW_LEFT, 20)
    point = page.execute_script("return window.fingerfem.point()")
    assert point[0] == pytest.approx(56.0) and point[2] < 0.015
    expected = model.evaluate(point)
    assert number(page, "contact-force") == pytest.approx(float(expected.contact_force), rel=1e-3)
    assert number(page, "touch-distance") == pytest.approx(1e3 * float(expected.touch_distance), rel=1e-3)
    assert page.find_element("id", "status").get_attribute("data-inside") == "true"
    assert page.get_screenshot_as_png() != before


def settled(driver) -> bytes:
    """A picture, once the page has followed."""
    driver.execute_async_script("document.activeElement.blur(); setTimeout(arguments[0], 500)")
    return driver.find_element("id", "canvas").screenshot_as_png


@pytest.mark.long
def test_a_mouse_a_finger_and_keys_turn_the_view(page):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    canvas, begun = page.find_element("id", "canvas"), settled(page)
    ActionChains(page).move_to_element(canvas).click_and_hold().move_by_offset(120, 40).release().perform()
    seen = [begun, settled(page)]
    chromium(page, "Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": 300, "y": 400}])
    for x in range(310, 400, 10):
        chromium(page, "Input.dispatchTouchEvent", type="touchMove", touchPoints=[{"x": x, "y": 400}])
    chromium(page, "Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    seen.append(settled(page))
    canvas.send_keys(Keys.ARROW_UP * 3)
    seen.append(settled(page))
    canvas.send_keys("-")
    seen.append(settled(page))
    assert len(set(seen)) == 5  # each of them has moved it
    canvas.send_keys(Keys.HOME)
    assert settled(page) == begun


@pytest.mark.long
def test_a_finger_on_the_glass_moves_a_slider(page):
    slider = page.find_element("id", "pull-0")
    box, before = slider.rect, page.execute_script("return window.fingerfem.point()")[0]
    middle = {"x": box["x"] + 0.9 * box["width"], "y": box["y"] + box["height"] / 2}
    chromium(page, "Input.dispatchTouchEvent", type="touchStart", touchPoints=[middle])
    chromium(page, "Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    settled(page)
    assert page.execute_script("return window.fingerfem.point()")[0] > before + 20


@pytest.mark.long
def test_it_holds_a_force_while_the_plane_moves(page):
    from selenium.webdriver.common.keys import Keys

    model = rom.load()
    page.find_element("id", "hold").send_keys(Keys.SPACE)
    for key, times in ((Keys.ARROW_RIGHT, 1), (Keys.ARROW_LEFT, 100), (Keys.ARROW_RIGHT, 200)):
        moved(page, "d", key, times)
        point = page.execute_script("return window.fingerfem.point()")
        assert model.evaluate(point).contact_force == pytest.approx(1.0, abs=1e-5)
        assert page.find_element("id", "said").get_attribute("data-status") == "converged"
    moved(page, "pull-0", Keys.ARROW_RIGHT, 5)  # whoever pulls himself lets go
    assert not page.find_element("id", "hold").is_selected()


def typed(driver, name: str, value: str) -> None:
    """Write into a number's field, as a person does, and wait until the page has followed."""
    field = driver.find_element("css selector", f"input[type=number][aria-label^='{name} ']")
    field.clear()
    field.send_keys(value, "\n")
    driver.execute_script("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def said(driver) -> tuple[str, str | None]:
    """The message of the last hold, and its status."""
    found = driver.find_element("id", "said")
    return found.text, found.get_attribute("data-status")


@pytest.mark.long
@pytest.mark.parametrize(
    "let_go", ["type", *(pytest.param(one, marks=pytest.mark.long) for one in ("uncheck", "pull"))]
)
def test_the_message_of_a_hold_goes_with_it(page, let_go):
    from selenium.webdriver.common.keys import Keys

    hold = page.find_element("id", "hold")
    typed(page, "force", "500")
    assert hold.is_selected() and said(page)[0].startswith("out of reach") and said(page)[1] == "unreachable"
    if let_go == "uncheck":
        moved(page, "hold", Keys.SPACE, 1)
    elif let_go == "pull":
        moved(page, "pull-0", Keys.ARROW_LEFT, 1)
    else:
        typed(page, "F2", "3")
    assert not hold.is_selected() and said(page) == ("", None)
    moved(page, "d", Keys.ARROW_RIGHT, 1)  # what does not hold leaves no message either
    assert not hold.is_selected() and said(page) == ("", None)
    moved(page, "hold", Keys.SPACE, 1)
    assert said(page)[0].startswith("out of reach")


@pytest.mark.long
def test_a_hold_that_is_refused_names_the_number_and_its_range(page):
    from selenium.webdriver.common.keys import Keys

    moved(page, "hold", Keys.SPACE, 1)
    typed(page, "d", "10000")
    assert said(page) == ("d must be from 0 to 50 mm, got 10000 mm", "out_of_domain")
    assert page.find_element("id", "status").get_attribute("data-inside") == "false"
    typed(page, "d", "10")
    assert said(page)[1] == "converged"
    typed(page, "force", "-1")
    assert said(page) == ("the force must be above 0 N, got -1 N", "out_of_domain")


@pytest.mark.long
def test_its_controller_is_the_robot_s(page):
    from control import Finger

    model = rom.load()
    finger, random = Finger(model), np.random.default_rng(1)
    agreed = 0
    for force, d in zip(random.uniform(0.1, 6.0, 60), random.uniform(0.0, 0.05, 60), strict=True):
        start = [50.0, 0.0]
        found = page.execute_script("return window.fingerfem.hold(...arguments)", start, force, d)
        known = finger.hold(force, d, start=start)
        agreed += found["status"] == known.status
        if found["status"] == "converged":
            answer = model.evaluate([*found["tensions"], d])
            assert answer.inside and answer.contact_force == pytest.approx(force, abs=1e-5)
    assert agreed >= 58  # its atlas is coarser: where a start leads nowhere it may begin elsewhere


def test_what_lies_outside_is_marked_with_the_reason(page):
    for name, value, reason in (("F1", "140", "beyond"), ("d", "-5", "beyond")):
        field = page.find_element("css selector", f"input[type=number][aria-label^='{name} ']")
        field.clear()
        field.send_keys(value, "\n")
        page.execute_script("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        text = page.find_element("id", "status").text
        assert reason in text and page.find_element("id", "scene").get_attribute("data-inside") == "false"
        field.clear()
        field.send_keys("20", "\n")


def test_nothing_is_fetched_and_nothing_complains(page):
    fetched = page.execute_script("return performance.getEntriesByType('resource').map((one) => one.name)")
    assert [one for one in fetched if not one.startswith(("data:", "blob:"))] == []
    assert [one for one in page.get_log("browser") if one["level"] in ("SEVERE", "WARNING")] == []


@pytest.mark.parametrize(
    "width", [360, pytest.param(800, marks=pytest.mark.long), pytest.param(1600, marks=pytest.mark.long)]
)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_phone_and_the_dark_have_all_of_it(page, width, scheme):
    emulated(page, "setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
    emulated(page, "setDeviceMetricsOverride", width=width, height=740, deviceScaleFactor=1, mobile=width < 500)
    try:
        assert page.execute_script("return document.documentElement.scrollWidth") <= width
        for name in ("canvas", "pull-0", "d", "hold", "contact-force", "status"):
            assert page.find_element("id", name).size["width"] > 0
        colour = page.execute_script("return getComputedStyle(document.body).backgroundColor")
        bright = np.mean([int(one) for one in re.findall(r"\d+", colour)[:3]])
        assert (bright < 60) == (scheme == "dark")
    finally:
        emulated(page, "clearDeviceMetricsOverride")
        emulated(page, "setEmulatedMedia", features=[])
