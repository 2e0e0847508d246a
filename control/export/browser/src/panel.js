// Sliders and readings beside the finger.

import { gradient } from "./colours.js";

const STEPS = 1000; // of a slider
const UNITS = { m: [1000, "mm"], N: [1, "N"], Pa: [0.001, "kPa"] }; // shown: factor, name
const DIGITS = 4;

/** A number for people: four digits; what is not known is a dash. */
export function told(value) {
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "–";
  return Math.abs(value) < 1e-9 ? "0" : String(Number(value.toPrecision(DIGITS)));
}

/** An error: two digits. */
export function off(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(2))) : "unknown";
}

function element(kind, properties = {}, ...children) {
  const found = Object.assign(document.createElement(kind), properties);
  found.append(...children);
  return found;
}

/** A slider and a field for one number; fields may leave the slider's range, so that what lies outside can be asked. */
export class Dial {
  constructor(place, { id, label, unit, lower, upper, title }, changed) {
    [this.factor, this.unit] = UNITS[unit];
    this.lower = lower;
    this.upper = upper;
    const ends = { min: lower * this.factor, max: upper * this.factor, step: ((upper - lower) * this.factor) / STEPS };
    this.slider = element("input", { type: "range", id, ...ends });
    this.field = element("input", { type: "number", step: "any", title: `${label} [${this.unit}]` });
    this.field.setAttribute("aria-label", `${label} in ${this.unit}`);
    const take = (from) => () => {
      if (from.value === "") return;
      this.value = Number(from.value) / this.factor;
      changed();
    };
    this.slider.addEventListener("input", take(this.slider));
    this.field.addEventListener("change", take(this.field));
    const name = element("label", { htmlFor: id, textContent: label, title: title ?? "" });
    place.append(element("div", { className: "dial" }, name, this.slider, this.field, element("span", { textContent: this.unit })));
  }

  get value() {
    return this.own;
  }

  set value(value) {
    this.own = value;
    this.slider.value = value * this.factor;
    this.field.value = told(value * this.factor);
    this.field.classList.toggle("beyond", !(value >= this.lower && value <= this.upper));
  }
}

/** A row of the answer: value, error, and both as a bar from 0 to `most`. */
export class Reading {
  constructor(place, { id, label, unit, most, title }) {
    [this.factor, this.unit] = UNITS[unit];
    this.most = most;
    this.number = element("output", { id });
    this.bar = element("i");
    this.range = element("b");
    this.mark = element("s", { hidden: true });
    const bar = element("div", { className: "bar", title: `0 to ${told(most * this.factor)} ${this.unit}` }, this.bar, this.range, this.mark);
    place.append(element("div", { className: "reading", title: title ?? "" }, element("span", { textContent: label }), this.number, bar));
  }

  /** Show a value and its error; `mark`, if given, stands on the bar. */
  show(value, error, mark) {
    this.number.textContent = Number.isFinite(value)
      ? `${told(value * this.factor)} ± ${off(error * this.factor)} ${this.unit}`
      : "not known";
    const share = (one) => Math.min(Math.max(one / this.most, 0), 1) * 100;
    this.bar.style.width = `${Number.isFinite(value) ? share(value) : 0}%`;
    const known = Number.isFinite(value) && Number.isFinite(error);
    this.range.hidden = !known;
    if (known) {
      this.range.style.left = `${share(value - error)}%`;
      this.range.style.width = `${Math.max(share(value + error) - share(value - error), 0.6)}%`;
    }
    this.mark.hidden = mark === undefined || !Number.isFinite(mark);
    if (!this.mark.hidden) this.mark.style.left = `${share(mark)}%`;
  }
}

/** The colour scale, from 0 to a displacement [m]. */
export function legend(place, most) {
  const ends = [0, 0.25, 0.5, 0.75, 1].map((share) => element("span", { textContent: told(share * most * 1000) }));
  const scale = element("div", { className: "scale" });
  scale.style.background = gradient();
  place.append("displacement [mm]", scale, element("div", { className: "ticks" }, ...ends));
}
