// The model: its C, compiled to WebAssembly, and its numbers as they lie in memory (rom/export/native/model.h).

const ROWS = 6, ERRORS = 4, LOADS = 3072, CORNERS = 12, QUATERNION = 4; // as in model.h and segment.h
const POINTER = 4; // [bytes]
const CONVERGED = 1, OUTSIDE = 4; // as in control/native/least_squares.h
const ALIGNED = 16, PAGE = 65536; // [bytes]
const HOLD_TOLERANCE = 1e-6; // [N]

/** Why an answer is not to be relied on, by its number in model.h. */
export const REASONS = [
  null,
  "no equilibrium was found",
  "beyond what was trained",
];

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (one) => one.charCodeAt(0));
}

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Functions of the system that nothing here needs, as the C library names them. */
function nothing() {
  return new Proxy({}, { get: () => () => 0 });
}

export class Model {
  /** @param about what Python wrote of the model; @param code the WebAssembly, both of the page. */
  static async load(about, code) {
    const imports = { wasi_snapshot_preview1: nothing(), env: nothing() };
    const { instance } = await WebAssembly.instantiate(await inflated(bytesOf(code)), imports);
    return new Model(about, instance.exports, await inflated(bytesOf(about.memory)));
  }

  constructor(about, code, memory) {
    this.about = about;
    this.parameters = about.parameters;
    this.code = code;
    code._initialize?.();
    this.end = code.__heap_base.value;
    const begin = this.take(memory.length);
    new Uint8Array(code.memory.buffer).set(memory, begin);
    const view = new DataView(code.memory.buffer);
    for (const at of about.addresses) view.setUint32(begin + at, view.getUint32(begin + at, true) + begin, true);
    this.struct = begin + about.root;
    const p = this.parameters.length;
    this.places = {
      memory: this.numbers(code.fingerfem_model_memory(this.struct)),
      point: this.numbers(p),
      loads: this.numbers(LOADS),
      out: this.numbers(ROWS),
      errors: this.numbers(ERRORS),
      jacobian: this.numbers(ROWS * p),
      corners: this.numbers(Math.max(CORNERS * about.sections, 1)),
      start: this.numbers(p),
      tensions: this.numbers(p),
      told: this.numbers(3),
      rows: this.numbers(QUATERNION + p - 1),
      slopes: this.numbers((QUATERNION + p - 1) * p),
      off: this.numbers(2),
      report: 0, // NULL
    };
    if (about.reports) this.places.report = this.pointers("rows", "slopes", "off"); // a struct fingerfem_report
  }

  /** Memory behind what is in use, which stays. */
  take(bytes) {
    const begin = Math.ceil(this.end / ALIGNED) * ALIGNED;
    this.end = begin + bytes;
    const missing = this.end - this.code.memory.buffer.byteLength;
    if (missing > 0) this.code.memory.grow(Math.ceil(missing / PAGE));
    return begin;
  }

  numbers(count) {
    return this.take(8 * count);
  }

  /** A struct of pointers to arrays. */
  pointers(...names) {
    const begin = this.take(POINTER * names.length), view = new DataView(this.code.memory.buffer);
    names.forEach((name, k) => view.setUint32(begin + POINTER * k, this.places[name], true));
    return begin;
  }

  at(name, count) {
    return new Float64Array(this.code.memory.buffer, this.places[name], count);
  }

  /** Tip [m], contact force [N], touch distance [m], pad pressure [Pa], their errors, and why not to rely on them; of a
   * finger of elements also the tip's orientation w, x, y, z and the tendons' shortenings [m]. */
  evaluate(point) {
    const { point: at, memory, loads, out, errors, jacobian, report } = this.places;
    this.at("point", point.length).set(point);
    this.at("loads", LOADS).fill(0);
    const status = this.code.fingerfem_model_evaluate(this.struct, at, memory, loads, out, errors, jacobian, report);
    const [x, y, z, force, touch, pad] = this.at("out", ROWS);
    const [tipError, forceError, touchError, padError] = this.at("errors", ERRORS);
    const rows = report ? [...this.at("rows", QUATERNION + point.length - 1)] : null;
    const [turnError, shorteningError] = this.at("off", 2);
    return {
      inside: status === 0,
      reason: REASONS[status],
      tip: [x, y, z],
      contact_force: force,
      touch_distance: touch,
      pad_pressure: pad,
      orientation: rows && rows.slice(0, QUATERNION),
      shortenings: rows && rows.slice(QUATERNION),
      error: {
        tip: tipError, contact_force: forceError, touch_distance: touchError, pad_pressure: padError,
        ...(rows && { orientation: turnError, shortenings: shorteningError }),
      },
    };
  }

  /** Corners of the surface's sections at the point that was told last, 12 numbers each [m]; null if not known. */
  sections() {
    const { point, memory, loads, corners } = this.places;
    if (!this.code.fingerfem_model_sections(this.struct, point, loads, memory, corners)) return null;
    return this.at("corners", CORNERS * this.about.sections);
  }

  /** Tensions near a start that press with a force [N] on the plane at d [m]: by the controllers' own code. */
  hold(start, force, d) {
    if (!this.finger) {
      this.finger = this.take(this.code.control_standalone_finger_size());
      this.code.control_standalone(this.struct, this.numbers(this.code.control_standalone_size(this.struct)), this.finger);
      this.places.memory_of_holds = this.numbers(this.code.control_standalone_memory(this.struct));
    }
    const { start: begin, memory_of_holds: memory, tensions, told } = this.places;
    this.at("start", start.length).set(start);
    const status = this.code.control_standalone_hold(this.finger, begin, force, d, HOLD_TOLERANCE, memory, tensions, told);
    const [residual, error, evaluations] = this.at("told", 3);
    const found = status === CONVERGED ? "converged" : status === OUTSIDE ? "out_of_domain" : "unreachable";
    return { status: found, residual, error, evaluations, tensions: [...this.at("tensions", start.length)] };
  }
}
