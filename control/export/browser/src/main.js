// The page: sliders -> the model -> the finger and its readings.

import { Model } from "./model.js";
import { Dial, legend, off, Reading, told } from "./panel.js";
import { View } from "./view.js";

const about = JSON.parse(document.getElementById("model").textContent);
const code = document.getElementById("code").textContent.trim();
const by = (id) => document.getElementById(id);
const BEGUN = 0.5; // of the tension that presses most, over its range
const PRESSED = 0.7; // of the touch distance
const HELD = 1.0; // [N]
const SMOOTH = 0.1; // share of the news in a mean

/** The next number with one digit: the end of a scale. */
function rounded(value) {
  const unit = 10 ** Math.floor(Math.log10(value));
  return unit * Math.ceil(value / unit);
}

async function start() {
  const model = await Model.load(about, code);
  const parameters = model.parameters, tendons = about.has_obstacle ? parameters.slice(0, -1) : parameters;
  const frames = { drawn: 0, milliseconds: 0 };
  let stale = true;
  const changed = () => (stale = true);

  by("title").textContent = about.title;
  by("about").textContent = about.description;
  const dials = tendons.map((one, k) => {
    const pulled = () => {
      release();
      changed();
    };
    const title = one.unit === "Pa" ? "pressure in a chamber" : "tension of a tendon";
    return new Dial(by("tensions"), { id: `pull-${k}`, label: one.name, title, ...one }, pulled);
  });
  const plane = about.has_obstacle
    ? new Dial(by("plane"), { id: "d", label: "d", title: "distance of the plane from the finger at rest", ...parameters.at(-1) }, changed)
    : null;
  const force = about.has_obstacle
    ? new Dial(by("force"), { id: "held-force", label: "force", unit: "N", lower: 0, upper: about.most_force }, () => {
        by("hold").checked = true;
        changed();
      })
    : null;
  by("contact").hidden = !about.has_obstacle;
  by("reports").hidden = !about.reports;
  by("chambers").hidden = !(about.reports && tendons.some((one) => one.unit === "Pa"));
  const silence = () => {
    by("said").textContent = "";
    delete by("said").dataset.status;
  };
  by("hold").addEventListener("change", () => {
    if (!by("hold").checked) silence();
    changed();
  });
  const release = () => {
    by("hold").checked = false;
    silence();
  };

  const reach = about.geometry.segments.reduce((a, b) => a + b, 0);
  const readings = {};
  if (about.has_obstacle) {
    readings.contact_force = new Reading(by("readings"), { id: "contact-force", label: "contact force", unit: "N", most: about.most_force });
    readings.touch_distance = new Reading(by("readings"), {
      id: "touch-distance", label: "touch distance", unit: "m", most: parameters.at(-1).upper,
      title: "distance of the plane at which the finger, pulled like this, touches it first; the mark is where the plane is",
    });
  }
  readings.tip = new Reading(by("readings"), { id: "tip-displacement", label: "tip displacement", unit: "m", most: 1.6 * reach });
  if (about.has_pad) readings.pad_pressure = new Reading(by("readings"), { id: "pad-pressure", label: "pad pressure", unit: "Pa", most: about.most_force / about.geometry.side ** 2 });

  const point = () => [...dials.map((one) => one.value), ...(plane ? [plane.value] : [])];
  const free = (tensions) => {
    model.evaluate(plane ? [...tensions, Infinity] : tensions);
    return model.sections()?.slice();
  };
  const rest = about.sections ? free(tendons.map((one) => Math.max(one.lower, 0))) : null;
  const moved = (sections, k) => Math.hypot(...[0, 1, 2].map((i) => sections[3 * k + i] - rest[3 * k + i]));
  const corners = Array.from({ length: 4 * about.sections }, (_, k) => k);
  let most = 0;
  for (let k = 1; rest && k < 2 ** tendons.length; k++) {
    const pulled = free(tendons.map((one, j) => ((k >> j) & 1 ? one.upper : one.lower)));
    most = corners.reduce((largest, one) => Math.max(largest, moved(pulled, one)), most);
  }
  most = rounded(most);
  if (rest) legend(by("legend"), most);
  by("sketch").hidden = about.sections > 0;

  dials.forEach((one) => (one.value = one.lower));
  dials[about.lead].value = BEGUN * (dials[about.lead].lower + dials[about.lead].upper);
  if (plane) {
    plane.value = plane.upper;
    const touch = PRESSED * model.evaluate(point()).touch_distance;
    plane.value = Math.min(Math.max(touch, plane.lower), plane.upper);
    force.value = Math.min(HELD, about.most_force);
  }

  let view = null;
  try {
    view = new View(by("canvas"), about);
  } catch {
    by("nothing").hidden = false;
  }

  /** Why no force can be held as the page is set; null if one may. */
  const refusal = () => {
    const millimetres = (value) => told(1000 * value);
    if (!(plane.value >= plane.lower && plane.value <= plane.upper))
      return `d must be from ${millimetres(plane.lower)} to ${millimetres(plane.upper)} mm, got ${millimetres(plane.value)} mm`;
    return force.value > 0 ? null : `the force must be above 0 N, got ${told(force.value)} N`;
  };

  const hold = () => {
    const found = model.hold(dials.map((one) => one.value), force.value, plane.value);
    const meant = {
      converged: `held within ${told(found.residual)} N, ± ${off(found.error)} N estimated`,
      unreachable: `out of reach: this is what comes nearest, ${told(found.residual)} N off`,
      out_of_domain: refusal() ?? "no answer within what was trained",
    };
    by("said").textContent = meant[found.status];
    by("said").dataset.status = found.status;
    if (found.status !== "out_of_domain") dials.forEach((one, k) => (one.value = found.tensions[k]));
  };

  const update = () => {
    if (plane && by("hold").checked) hold();
    const at = point(), answer = model.evaluate(at), sections = about.sections ? model.sections() : null;
    readings.contact_force?.show(answer.contact_force, answer.error.contact_force);
    readings.touch_distance?.show(answer.touch_distance, answer.error.touch_distance, plane.value);
    readings.tip.show(Math.hypot(...answer.tip), answer.error.tip);
    readings.pad_pressure?.show(answer.pad_pressure, answer.error.pad_pressure);
    by("tip").textContent = answer.tip.map((one) => (1000 * one).toFixed(2)).join(", ");
    if (about.reports) {
      const strokes = (unit, factor) =>
        tendons.flatMap((one, k) => (one.unit === unit ? `${one.name} ${(factor * answer.shortenings[k]).toFixed(3)}` : [])).join(", ");
      by("orientation").textContent = `${answer.orientation.map((one) => one.toFixed(4)).join(", ")} ± ${off(answer.error.orientation)} rad`;
      by("shortenings").textContent = `${strokes("N", 1e3)} ± ${off(1e3 * answer.error.shortenings)}`;
      by("growths").textContent = `${strokes("Pa", 1e9)} ± ${off(Number.isFinite(answer.error.shortenings) ? 1e9 * about.growth_error : NaN)}`;
    }
    by("status").dataset.inside = answer.inside;
    by("status").textContent = answer.inside ? "inside what was trained" : `not to be relied on: ${answer.reason}`;
    by("scene").dataset.inside = answer.inside;
    const range = (one, k) => (dials[k].value - one.lower) / (one.upper - one.lower);
    view?.show({
      sections,
      shares: sections ? corners.map((k) => moved(sections, k) / most) : [],
      pulls: tendons.map(range),
      d: plane ? plane.value : Infinity,
      tip: answer.tip.map((one, i) => one + about.rest[i]),
      marked: !answer.inside,
    });
  };

  const frame = (now) => {
    requestAnimationFrame(frame);
    const begun = performance.now(), news = stale;
    if (news) {
      stale = false;
      update();
    }
    const drawn = view?.draw(now);
    if (!news && !drawn) return;
    frames.drawn += 1;
    frames.milliseconds += SMOOTH * (performance.now() - begun - frames.milliseconds);
  };
  requestAnimationFrame(frame);

  by("home").addEventListener("click", () => view?.home());
  // For tests, and for whoever wants to ask the model from the browser's console.
  window.fingerfem = { model, frames, point, evaluate: (at) => model.evaluate(at), hold: (begin, aim, d) => model.hold(begin, aim, d) };
  document.body.dataset.ready = "true";
}

start().catch((error) => {
  by("status").dataset.inside = "false";
  by("status").textContent = `this browser cannot run the page: ${error.message}`;
});
