// The finger, its tendons, the clamp and the plane in three dimensions.

import {
  AmbientLight, BoxGeometry, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, GridHelper, Mesh,
  MeshBasicMaterial, MeshStandardMaterial, PerspectiveCamera, PlaneGeometry, Scene, SphereGeometry, Spherical, SRGBColorSpace, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { colour } from "./colours.js";

const SQUARE = 0.01; // of the plane's grid [m]
const PLATE = [150, 155, 165], SLACK = 0x8a8f98, PULLED = 0xff7a1a, MARKED = 0x9a9a9a;
const CORNERS = 4; // of a section's box, which its points have weights of
const TURN = 0.08, NEARER = 1.1; // of a key [rad, -]
// While it moves, frames that take longer [ms] are drawn with fewer pixels [-], until it has been still for so long [ms].
const SLOW = 1000 / 50, COARSER = 0.8, COARSEST = 0.4, STILL = 250;
const UNIT = 1000; // of the scene in a metre: millimetres

/** A sum over a section's corners. */
function weighted(weights, of) {
  return weights.reduce((sum, weight, corner) => sum + weight * of(corner), 0);
}

/** A point of a section in the scene, by the weights of its corners. */
function placed(sections, section, weights) {
  return [0, 1, 2].map((i) => UNIT * weighted(weights, (corner) => sections[3 * (CORNERS * section + corner) + i]));
}

export class View {
  /** @param canvas where; @param about of the model: sections, which of them are a plate's, geometry, tendons. */
  constructor(canvas, about) {
    this.canvas = canvas;
    this.about = about;
    this.shade = new Color();
    this.share = 1; // of the pixels along a side that are drawn
    this.late = this.drawn = 0; // slow frames one after another; when the last was drawn [ms]
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new Scene();
    this.scene.add(new AmbientLight(0xffffff, 1.9));
    for (const place of [[1, -2, 4], [-2, 1, -3]]) {
      const light = new DirectionalLight(0xffffff, 1.2);
      light.position.set(...place);
      this.scene.add(light);
    }
    this.length = UNIT * about.geometry.segments.reduce((a, b) => a + b, 0);
    this.side = UNIT * about.geometry.side;
    this.camera = new PerspectiveCamera(32, 1, 1, 50 * this.length);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => (this.stale = true));
    this.home();
    this.addClamp();
    this.addPlane();
    if (about.sections) this.addFinger();
    this.tip = new Mesh(new SphereGeometry(this.side / 12), new MeshBasicMaterial({ color: 0xd11f5a, depthTest: false }));
    this.tip.renderOrder = 3;
    this.scene.add(this.tip);
    this.tendons = about.sections ? about.tendons.map((tendon) => this.addTendon(tendon)) : [];
    canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.fit()).observe(canvas.parentElement);
    this.fit();
  }

  home() {
    const target = new Vector3(0.45 * this.length, 0.3 * this.length, 0);
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(new Vector3(0.32, -0.4, 2.25).multiplyScalar(this.length));
    this.controls.update();
    this.stale = true;
  }

  addClamp() {
    const clamp = new Mesh(new BoxGeometry(0.3 * this.side, 1.8 * this.side, 1.8 * this.side), new MeshStandardMaterial({ color: 0x4a5160 }));
    clamp.position.x = -0.15 * this.side;
    this.scene.add(clamp);
  }

  addPlane() {
    const size = UNIT * SQUARE * 2 * Math.ceil((0.75 * this.length) / (UNIT * SQUARE));
    const face = new MeshBasicMaterial({ color: 0x4f8fd6, transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false });
    this.plane = new Mesh(new PlaneGeometry(size, size), face);
    this.plane.rotation.x = Math.PI / 2;
    this.grid = new GridHelper(size, Math.round(size / (UNIT * SQUARE)), 0x4f8fd6, 0x4f8fd6);
    this.grid.material.transparent = true;
    this.grid.material.opacity = 0.45;
    for (const one of [this.plane, this.grid]) {
      one.position.x = size / 2 - 0.1 * this.length;
      one.visible = this.about.has_obstacle;
      this.scene.add(one);
    }
  }

  /** The border of every segment's rubber and its plate in flat faces, each with points of its own, so that edges are sharp. */
  addFinger() {
    const { metal, border } = this.about;
    this.from = []; // vertex -> section and weights of its corners
    this.plates = []; // vertex -> whether it is a plate's
    const face = (plate, ...points) => {
      for (const [section, k] of points) {
        this.from.push([section, border[k % border.length]]);
        this.plates.push(plate);
      }
    };
    const last = metal.length - 1;
    for (let s = 0; s < last; s++)
      for (let k = 0; k < border.length; k++) {
        face(metal[s], [s, k], [s, k + 1], [s + 1, k + 1]);
        face(metal[s], [s, k], [s + 1, k + 1], [s + 1, k]);
      }
    for (let k = 1; k < border.length - 1; k++) face(metal[last], [last, 0], [last, k], [last, k + 1]);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * this.from.length), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * this.from.length), 3));
    const material = new MeshStandardMaterial({ vertexColors: true, flatShading: true, roughness: 0.75, side: DoubleSide });
    this.finger = new Mesh(geometry, material);
    this.finger.frustumCulled = false;
    this.scene.add(this.finger);
  }

  addTendon(tendon) {
    const line = new Line2(new LineGeometry(), new LineMaterial({ linewidth: 2.5, depthTest: false, transparent: true }));
    line.frustumCulled = false;
    line.renderOrder = 2;
    this.scene.add(line);
    return { line, ...tendon };
  }

  /** Show sections [m], shares of the colour scale by their corners, tensions as shares, the plane at d, the tip. */
  show({ sections, shares, pulls, d, tip, marked }) {
    if (sections && this.finger) {
      const { position, color } = this.finger.geometry.attributes;
      this.from.forEach(([section, weights], k) => {
        position.setXYZ(k, ...placed(sections, section, weights));
        const [r, g, b] = this.plates[k] ? PLATE : colour(weighted(weights, (corner) => shares[CORNERS * section + corner]));
        this.shade.setRGB(r / 255, g / 255, b / 255, SRGBColorSpace);
        color.setXYZ(k, this.shade.r, this.shade.g, this.shade.b);
      });
      position.needsUpdate = color.needsUpdate = true;
      this.finger.material.color.set(marked ? MARKED : 0xffffff);
      this.tendons.forEach((tendon, k) => this.drawTendon(tendon, sections, pulls[k]));
    }
    this.plane.position.y = this.grid.position.y = this.side / 2 + UNIT * d;
    this.plane.visible = this.grid.visible = this.about.has_obstacle && Number.isFinite(d);
    this.tip.position.set(...tip.map((one) => UNIT * one));
    this.stale = true;
  }

  drawTendon({ line, weights, last, straight }, sections, pull) {
    const places = [];
    for (let s = 0; s <= last; s++) {
      if (straight && s > 0 && s < last) continue;
      places.push(...placed(sections, s, weights));
    }
    line.geometry.setPositions(places);
    line.material.color.set(pull > 0 ? PULLED : SLACK);
    line.material.opacity = 0.45 + 0.55 * Math.min(pull, 1);
  }

  key(event) {
    const away = this.camera.position.clone().sub(this.controls.target), at = new Spherical().setFromVector3(away);
    const turns = { ArrowLeft: [-TURN, 0], ArrowRight: [TURN, 0], ArrowUp: [0, -TURN], ArrowDown: [0, TURN] };
    if (event.key === "Home") this.home();
    else if (event.key === "+" || event.key === "=") at.radius /= NEARER;
    else if (event.key === "-") at.radius *= NEARER;
    else if (event.key in turns) {
      at.theta += turns[event.key][0];
      at.phi += turns[event.key][1];
    } else return;
    event.preventDefault();
    if (event.key === "Home") return;
    this.camera.position.copy(this.controls.target).add(new Vector3().setFromSpherical(at.makeSafe()));
    this.controls.update();
    this.stale = true;
  }

  fit() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setPixelRatio(this.share * Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.fov = width < height ? 45 : 32;
    this.camera.updateProjectionMatrix();
    this.stale = true;
  }

  /** Draw, if anything has changed; where that is slow, with fewer pixels until it is still again. */
  draw(now) {
    const since = now - this.drawn;
    if (!this.stale && this.share < 1 && since > STILL) this.resolve(1);
    if (!this.stale) return false;
    if (since < STILL) this.late = since > SLOW ? this.late + 1 : 0;
    if (this.late > 2 && this.share > COARSEST) this.resolve(Math.max(COARSER * this.share, COARSEST));
    this.stale = false;
    this.drawn = now;
    this.renderer.render(this.scene, this.camera);
    return true;
  }

  /** Use a share of the pixels that there are along a side. */
  resolve(share) {
    this.share = share;
    this.late = 0;
    this.fit();
  }
}
