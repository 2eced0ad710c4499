/* The viewer of scenes: geometry, joints, bolts and moving complex modes, on three.js.
 *
 *   import { mount } from "./viewer.js";
 *   const view = await mount(element, scene, { onPick, onShow });
 *
 * `scene` is what faying.output.scene.to_text writes, parsed. `mount` fills the element and throws where the browser has
 * no WebGL 2. It loads nothing, evaluates no text, and sets styles through the object model alone, so that a page may
 * forbid all three by its content security policy.
 *
 *   onPick({part, number, name, area, centre, normal} | null)   a face was picked, or the selection was cleared:
 *                               part by name, number of the face on it from 1, SI units
 *   onShow(state)               what is shown has changed (a copy of view.state)
 *
 *   await view.show({load, mode, phase, amplitude, speed, playing, field, outline, fixings, names})
 *                               changes some of what is shown, and resolves when it is. load, mode: from 0, mode null
 *                               for the structure at rest; phase [degrees]; amplitude: greatest motion over the size of
 *                               the structure; speed: cycles a second; field: "parts", "motion" or one of scene.fields;
 *                               outline: the structure at rest beside the moved one; fixings: bolts, supports, masses
 *   view.state                  what is shown
 *   view.pick(x, y)             the face at a place of the canvas [CSS pixels], as onPick gets it; null beside it
 *   view.reading(x, y)          what a map shows at a place of the canvas, {joint, field, value [SI]}; null beside it
 *   view.select(part, number)   selects a face as a click does; view.select(null) clears
 *   view.highlight([{part, number}])   colours faces; an empty list ends it
 *   view.joint(name, {look})    highlights both faces of a joint by its name; look: also turns the view square to it;
 *                               null ends it
 *   view.hide(part), view.unhide(part)   by name
 *   view.look(direction)        "x", "-x", "y", "-y", "z", "-z" or "corner"; fits the structure into the view
 *   view.positions(part)        {nodes, positions}: nodes of a part and where they are shown now [m], three numbers each:
 *                               points + amplitude size / peak (cos(phase) real - sin(phase) imaginary), with peak the
 *                               greatest root of |real|^2 + |imaginary|^2 over all nodes
 *   view.pixels()               {width, height, data}: the canvas now, RGBA, lowest row first
 *   view.project(point)         where a point of the model [m] lies on the canvas [CSS pixels]
 *   view.draws                  frames drawn so far
 *   view.dispose()              removes everything
 */
import * as THREE from "./vendor/three.min.js";

const VIRIDIS = [
  0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c, 0x1fa088, 0x28ae80,
  0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725,
];
const PARTS = [0x8fa9c4, 0xc4a98f, 0x93b8a4, 0xb3a0c2, 0xc0b283, 0x86b3bf, 0xc29aa5, 0xa3a8ae];
const CARRIED = ["pressure", "k_n", "k_t"]; // fields that vanish where a joint is open
const OVERLAYS = 124; // pixels of the view that titles and scales take of its height
const SELECTED = 0xe07b1f;
const SMOOTHED = 1e5; // triangles up to which edges are smoothed
const THEMES = {
  light: { edge: 0x2b3844, rest: 0x8a97a5, bolt: 0x59656f, support: 0x0b7a75, mass: 0x8a3b8f },
  dark: { edge: 0x0b0f13, rest: 0x77828e, bolt: 0xa9b4be, support: 0x35b8b0, mass: 0xcf86d3 },
};
const STYLE = `
.fv{--ink:#1c2733;--soft:#52616f;--line:#cfd7df;--panel:#f6f8fa;--back:#fff;--accent:#0a63b0;container-type:inline-size;
  position:relative;height:100%;min-height:22rem;color:var(--ink);font:14px/1.4 system-ui,sans-serif;text-align:left}
.fv *{box-sizing:border-box}
.fv-all{display:grid;grid-template-columns:minmax(0,1fr) 15.5rem;height:100%;min-height:22rem;background:var(--back)}
.fv-stage{position:relative;min-width:0;min-height:20rem;overflow:hidden}
.fv-stage canvas{position:absolute;inset:0;width:100%;height:100%;display:block;touch-action:none;cursor:grab}
.fv-stage canvas:active{cursor:grabbing}
.fv-stage canvas:focus-visible{outline:2px solid var(--accent);outline-offset:-2px}
.fv-over{position:absolute;pointer-events:none;color:var(--ink)}
.fv-head{left:.8rem;top:.6rem;right:.8rem;font-variant-numeric:tabular-nums}
.fv-head strong{font-weight:600}.fv-head div{color:var(--soft);font-size:.86em}
.fv-axes{left:.4rem;bottom:.4rem;width:84px;height:84px}
.fv-axes text{font:600 12px system-ui,sans-serif;fill:var(--ink);text-anchor:middle;dominant-baseline:central}
.fv-axes line{stroke-width:2;stroke-linecap:round}
.fv-scale{left:6.4rem;bottom:.8rem;font-size:.82em;color:var(--soft);text-align:center;
  font-variant-numeric:tabular-nums}
.fv-scale i{display:block;height:5px;border:1px solid var(--soft);border-top:0;margin-top:1px}
.fv-bar,.fv-head strong,.fv-head div{background:color-mix(in srgb,var(--back) 72%,transparent);border-radius:4px}
.fv-head strong,.fv-head div{width:fit-content;padding:0 .25rem;margin-left:-.25rem;display:block}
.fv-bar{right:.5rem;bottom:.5rem;padding:.3rem;font-size:.82em;color:var(--soft);font-variant-numeric:tabular-nums;width:13rem;
  max-width:45%}
.fv-bar i{display:block;height:.7rem;border-radius:2px;margin:.15rem 0}
.fv-bar span{display:flex;justify-content:space-between}
.fv-label{position:absolute;left:0;top:0;pointer-events:none;font-size:.8em;padding:0 .3em;border-radius:3px;
  background:color-mix(in srgb,var(--back) 82%,transparent);color:var(--ink);white-space:nowrap;max-width:14em;
  overflow:hidden;text-overflow:ellipsis}
.fv-panel{border-left:1px solid var(--line);background:var(--panel);padding:.7rem .8rem;overflow-y:auto;min-width:0}
.fv-panel>div,.fv-panel fieldset{margin:0 0 .75rem}
.fv-panel fieldset{border:0;padding:0;min-width:0}
.fv-panel legend,.fv-panel label.fv-top,.fv-panel .fv-top{display:flex;justify-content:space-between;gap:.5rem;padding:0;
  font-size:.86em;color:var(--soft);margin-bottom:.12rem}
.fv-panel output{font-variant-numeric:tabular-nums;color:var(--ink)}
.fv-panel select{width:100%;font:inherit;color:inherit;background:var(--back);border:1px solid var(--line);
  border-radius:5px;padding:.25rem .3rem}
.fv-panel input[type=range]{width:100%;margin:.1rem 0;accent-color:var(--accent);display:block}
.fv-panel input[type=checkbox]{accent-color:var(--accent);margin:0;flex:none}
.fv-row{display:flex;gap:.35rem;flex-wrap:wrap}
.fv-panel button{font:inherit;color:inherit;background:var(--back);border:1px solid var(--line);border-radius:5px;
  padding:.2rem .55rem;cursor:pointer;flex:1 1 auto;min-height:1.9rem}
.fv-panel button:hover{border-color:var(--accent)}
.fv-panel :is(button,select,input):focus-visible{outline:2px solid var(--accent);outline-offset:1px}
.fv-check{display:flex;align-items:center;gap:.45rem;padding:.1rem 0;min-width:0;overflow-wrap:anywhere}
.fv-check b{width:.8em;height:.8em;border-radius:2px;flex:none}
.fv-list{max-height:11rem;overflow-y:auto}
.fv-note{font-size:.86em;color:var(--soft);margin:0}
.fv-facts{font-size:.9em;margin:0;min-height:1.4em;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
.fv-hidden{display:none!important}
@container (max-width:680px){
  .fv-all{grid-template-columns:minmax(0,1fr);grid-template-rows:minmax(20rem,1fr) auto;height:auto;min-height:100%}
  .fv-panel{border-left:0;border-top:1px solid var(--line);display:grid;gap:0 1.2rem;max-height:none;
    grid-template-columns:repeat(auto-fit,minmax(13rem,1fr));align-items:start}
}
@media (prefers-color-scheme:dark){
  .fv{--ink:#e3e8ee;--soft:#a3afbb;--line:#38424d;--panel:#1a2027;--back:#14181d;--accent:#63b0f0;color-scheme:dark}
}
@media print{.fv{display:none}}
`;

const VERTEX = `
attribute vec3 re; attribute vec3 im; attribute float face; attribute float value;
uniform float amp; uniform float co; uniform float si;
varying vec3 vPlace; varying float vMotion; varying float vValue; flat varying float vFace;
void main() {
  vec4 at = modelViewMatrix * vec4(position + amp * (co * re - si * im), 1.0);
  vPlace = at.xyz; vMotion = sqrt(dot(re, re) + dot(im, im)); vValue = value; vFace = face;
  gl_Position = projectionMatrix * at;
}`;
const FRAGMENT = `
uniform vec3 tint; uniform float alpha; uniform int kind; uniform float size; uniform sampler2D scale;
uniform sampler2D marks; uniform vec3 marked; uniform float least;
varying vec3 vPlace; varying float vMotion; varying float vValue; flat varying float vFace;
void main() {
  vec3 normal = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
  float light = 0.5 + 0.32 * max(dot(normal, normalize(vec3(0.35, 0.5, 0.8))), 0.0) + 0.2 * abs(normal.z);
  vec3 colour = tint;
  if (kind == 1) colour = texture2D(scale, vec2(clamp(vMotion / size, 0.002, 0.998), 0.5)).rgb;
  if (kind == 2) {
    colour = texture2D(scale, vec2(clamp(vValue, 0.002, 0.998), 0.5)).rgb;
    if (least > 0.0) colour = mix(vec3(0.88), colour, smoothstep(0.0, least, vValue));
  }
  float a = alpha;
  if (vFace >= 0.0) {
    int f = int(vFace + 0.5);
    float mark = texelFetch(marks, ivec2(f % 1024, f / 1024), 0).r;
    if (mark > 0.0 && kind != 2) { colour = mix(colour, marked, 0.8 * mark); if (alpha < 1.0) a = max(a, 0.35 * mark); }
  }
  if (kind > 0) light = 0.75 + 0.25 * (light - 0.5) * 2.0;
  gl_FragColor = vec4(colour * light, a);
}`;
const PICK = `
flat varying float vFace; varying vec3 vPlace; varying float vMotion; varying float vValue;
void main() {
  float f = vFace + 1.0;
  gl_FragColor = vec4(mod(f, 256.0), mod(floor(f / 256.0), 256.0), floor(f / 65536.0), 255.0) / 255.0;
}`;
const LINE = `
uniform vec3 tint; uniform float alpha; varying vec3 vPlace; varying float vMotion; varying float vValue;
flat varying float vFace;
void main() { gl_FragColor = vec4(tint, alpha); }`;

const TYPES = { f4: Float32Array, i2: Int16Array, u2: Uint16Array, u4: Uint32Array };

/** The numbers of one packed array. */
async function unpacked(packed) {
  const text = atob(packed.data);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new TYPES[packed.type](await new Response(plain).arrayBuffer());
}

/** An element with properties and children; all text is text, never markup. */
function make(tag, given = {}, ...children) {
  const found = document.createElement(tag);
  for (const [key, value] of Object.entries(given)) {
    if (key === "class") found.className = value;
    else if (key.startsWith("on")) found.addEventListener(key.slice(2), value);
    else if (key in found && typeof value !== "string") found[key] = value;
    else found.setAttribute(key, value);
  }
  found.append(...children);
  return found;
}

const digits = (x, n = 4) => {
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e5 || size < 1e-3) return x.toExponential(n - 2).replace("e+", "e");
  return String(Number(x.toPrecision(n)));
};
const hex = (colour) => `#${colour.toString(16).padStart(6, "0")}`;

let styled = null;
function style() {
  if (styled === null) {
    styled = new CSSStyleSheet();
    styled.replaceSync(STYLE);
  }
  if (!document.adoptedStyleSheets.includes(styled)) document.adoptedStyleSheets = [...document.adoptedStyleSheets, styled];
}

function lookupTexture() {
  const data = new Uint8Array(256 * 4);
  for (let k = 0; k < 256; k++) {
    const x = (k / 255) * 16, i = Math.min(15, Math.floor(x)), t = x - i;
    for (let c = 0; c < 3; c++) {
      const [a, b] = [VIRIDIS[i], VIRIDIS[i + 1]].map((v) => (v >> (16 - 8 * c)) & 255);
      data[4 * k + c] = Math.round(a + t * (b - a));
    }
    data[4 * k + 3] = 255;
  }
  const texture = new THREE.DataTexture(data, 256, 1, THREE.RGBAFormat, THREE.UnsignedByteType);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

const rgb = (colour) => new THREE.Vector3(((colour >> 16) & 255) / 255, ((colour >> 8) & 255) / 255, (colour & 255) / 255);

/** Everything that is drawn: meshes of the parts, edges, maps, bolts, supports, masses. */
class Model {
  constructor(scene, arrays) {
    this.scene = scene;
    this.points = arrays.points;
    this.root = new THREE.Scene();
    this.moving = []; // {nodes, geometry} whose re and im follow the mode
    const faces = scene.faces.length;
    this.marks = new Uint8Array(1024 * Math.max(1, Math.ceil(faces / 1024)) * 4);
    this.markTexture = new THREE.DataTexture(this.marks, 1024, this.marks.length / 4096, THREE.RGBAFormat, THREE.UnsignedByteType);
    this.markTexture.needsUpdate = true;
    this.shared = {
      amp: { value: 0 }, co: { value: 1 }, si: { value: 0 }, size: { value: scene.size },
      scale: { value: lookupTexture() }, marks: { value: this.markTexture }, marked: { value: rgb(SELECTED) },
      least: { value: -1 }, // values fade from pale, no contact, to their colour up to this
    };
    this.rest = { ...this.shared, amp: { value: 0 } };
    this.pickMaterial = this.material(PICK, {}, { side: THREE.DoubleSide });
    this.parts = scene.parts.map((part, k) => this.part(part, k, arrays));
    this.edges = scene.parts.map((part, k) => this.partEdges(k, arrays));
    this.maps = scene.joints.map((joint) => (joint.map === null ? null : this.map(joint, arrays)));
    this.bolts = scene.bolts.map((bolt) => this.bolt(bolt));
    this.supports = scene.supports.map((support) => this.support(support));
    this.masses = scene.masses.map((mass) => this.mass(mass));
  }

  material(fragment, own, options = {}, shared = this.shared) {
    return new THREE.ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: fragment, uniforms: { ...shared, ...own }, ...options,
    });
  }

  geometry(nodes, index, faces) {
    const count = nodes.length, geometry = new THREE.BufferGeometry();
    const place = new Float32Array(3 * count);
    for (let v = 0; v < count; v++) for (let k = 0; k < 3; k++) place[3 * v + k] = this.points[3 * nodes[v] + k];
    return this.filled(geometry, place, nodes, index, faces);
  }

  filled(geometry, place, nodes, index, faces) {
    const count = place.length / 3;
    geometry.setAttribute("position", new THREE.BufferAttribute(place, 3));
    geometry.setAttribute("re", new THREE.BufferAttribute(new Float32Array(3 * count), 3));
    geometry.setAttribute("im", new THREE.BufferAttribute(new Float32Array(3 * count), 3));
    geometry.setAttribute("face", new THREE.BufferAttribute(faces ?? new Float32Array(count).fill(-1), 1));
    geometry.setAttribute("value", new THREE.BufferAttribute(new Float32Array(count), 1));
    if (index) geometry.setIndex(new THREE.BufferAttribute(index, 1));
    this.moving.push({ nodes, geometry });
    return geometry;
  }

  add(object) {
    object.frustumCulled = false;
    object.matrixAutoUpdate = false;
    this.root.add(object);
    return object;
  }

  /** Triangles of a part; a node has one vertex for each face that it is on, so that a vertex knows its face. */
  part(part, number, { triangles, face_of_triangle: faceOf }) {
    const { faces } = this.scene, count = faces.length;
    const known = new Map(), nodes = [], ids = [], index = [];
    for (let t = 0; t < faceOf.length; t++) {
      const face = faceOf[t];
      if (faces[face].part !== number) continue;
      for (let k = 0; k < 3; k++) {
        const node = triangles[3 * t + k], key = node * count + face;
        let vertex = known.get(key);
        if (vertex === undefined) {
          vertex = nodes.length;
          known.set(key, vertex);
          nodes.push(node);
          ids.push(face);
        }
        index.push(vertex);
      }
    }
    const geometry = this.geometry(Uint32Array.from(nodes), Uint32Array.from(index), Float32Array.from(ids));
    const material = this.material(
      FRAGMENT,
      { tint: { value: rgb(PARTS[number % PARTS.length]) }, alpha: { value: 1 }, kind: { value: 0 } },
      { side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 },
    );
    const mesh = this.add(new THREE.Mesh(geometry, material));
    mesh.userData = { nodes: Uint32Array.from(new Set(nodes)).sort() };
    return mesh;
  }

  partEdges(number, { edges, triangles, face_of_triangle: faceOf }) {
    if (this.partOfNode === undefined) {
      this.partOfNode = new Int32Array(this.points.length / 3).fill(-1);
      for (let t = 0; t < faceOf.length; t++)
        for (let k = 0; k < 3; k++) this.partOfNode[triangles[3 * t + k]] = this.scene.faces[faceOf[t]].part;
    }
    const nodes = [];
    for (let e = 0; e < edges.length; e += 2)
      if (this.partOfNode[edges[e]] === number) nodes.push(edges[e], edges[e + 1]);
    const geometry = this.geometry(Uint32Array.from(nodes), null, null);
    const own = () => ({ tint: { value: rgb(0) }, alpha: { value: 1 } });
    const line = (shared, more) => this.add(new THREE.LineSegments(geometry, this.material(LINE, own(), more, shared)));
    return {
      moved: line(this.shared, {}),
      rest: line(this.rest, { transparent: true, depthWrite: false }),
    };
  }

  /** The map of a joint on its first face; corners lie half-way between two nodes and move so. */
  map(joint, arrays) {
    const parents = arrays[`${joint.map}.parents`], index = arrays[`${joint.map}.triangles`];
    const count = parents.length / 2, place = new Float32Array(3 * count);
    for (let v = 0; v < count; v++)
      for (let k = 0; k < 3; k++)
        place[3 * v + k] = (this.points[3 * parents[2 * v] + k] + this.points[3 * parents[2 * v + 1] + k]) / 2;
    const faces = new Float32Array(count).fill(joint.faces.length ? joint.faces[0] : -1);
    const geometry = this.filled(new THREE.BufferGeometry(), place, parents, index, faces);
    const own = { tint: { value: rgb(0) }, alpha: { value: 1 }, kind: { value: 2 } };
    // drawn after the parts, which are transparent then: nothing dulls its colours
    const mesh = this.add(new THREE.Mesh(geometry, this.material(FRAGMENT, own, { side: THREE.DoubleSide, transparent: true })));
    mesh.renderOrder = 3;
    mesh.visible = false;
    return mesh;
  }

  /** A solid of its own whose ends follow the nodes nearest to them. */
  solid(place, index, nodes, material) {
    const geometry = this.filled(new THREE.BufferGeometry(), place, nodes, index, null);
    return this.add(new THREE.Mesh(geometry, material));
  }

  tinted(name) {
    const own = { tint: { value: rgb(0) }, alpha: { value: 1 }, kind: { value: 0 }, theme: { value: name } };
    return this.material(FRAGMENT, own, { side: THREE.DoubleSide });
  }

  nearest(point) {
    let best = 0, least = Infinity;
    for (let n = 0; n < this.points.length; n += 3) {
      const d = (this.points[n] - point.x) ** 2 + (this.points[n + 1] - point.y) ** 2 + (this.points[n + 2] - point.z) ** 2;
      if (d < least) [least, best] = [d, n / 3];
    }
    return best;
  }

  bolt({ seats, diameter: d, head: wide, meshed }) {
    if (meshed) return null; // it is drawn as a part
    const [head, nut] = seats.map((p) => new THREE.Vector3(...p));
    const axis = nut.clone().sub(head).normalize();
    const tall = Math.min(0.7 * d, 0.6 * wide), r = wide / 2;
    const rings = [
      [head, -tall, 0], [head, -tall, r], [head, 0, r], [head, 0, d / 2],
      [nut, 0, d / 2], [nut, 0, r], [nut, tall, r], [nut, tall, 0],
    ];
    return this.turned(rings, axis, [this.nearest(head), this.nearest(nut)], head, this.tinted("bolt"));
  }

  /** A body of revolution from rings [centre, offset along the axis, radius]; each follows the node of its end. */
  turned(rings, axis, ends, first, material, sides = 24) {
    const helper = Math.abs(axis.z) < 0.8 ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(1, 0, 0);
    const u = helper.cross(axis).normalize(), w = axis.clone().cross(u);
    const place = [], nodes = [], index = [];
    rings.forEach(([centre, along, radius], r) => {
      for (let k = 0; k < sides; k++) {
        const angle = (2 * Math.PI * k) / sides;
        const at = centre.clone().addScaledVector(axis, along);
        at.addScaledVector(u, radius * Math.cos(angle)).addScaledVector(w, radius * Math.sin(angle));
        place.push(at.x, at.y, at.z);
        nodes.push(centre === first ? ends[0] : ends[1]);
        if (r > 0) {
          const a = (r - 1) * sides + k, b = (r - 1) * sides + ((k + 1) % sides);
          index.push(a, b, a + sides, b, b + sides, a + sides);
        }
      }
    });
    return this.solid(Float32Array.from(place), Uint32Array.from(index), Uint32Array.from(nodes), material);
  }

  /** One cone for each direction in which the face is held, its tip on the face's centre; two for springs. */
  support({ face, directions, elastic }) {
    const centre = new THREE.Vector3(...this.scene.faces[face].centre), length = 0.045 * this.scene.size;
    const normal = this.scene.faces[face].normal, node = this.nearest(centre);
    return directions.map((name) => {
      const k = "xyz".indexOf(name), axis = new THREE.Vector3(k === 0, k === 1, k === 2);
      if (normal[k] < 0) axis.negate();
      const rings = elastic
        ? [[centre, 0, 0], [centre, 0.5 * length, 0.25 * length], [centre, 0.5 * length, 0], [centre, length, 0.25 * length], [centre, length, 0]]
        : [[centre, 0, 0], [centre, length, 0.3 * length], [centre, length, 0]];
      return this.turned(rings, axis, [node, node], centre, this.tinted("support"), 16);
    });
  }

  mass({ point }) {
    const centre = new THREE.Vector3(...point), r = 0.018 * this.scene.size, node = this.nearest(centre);
    const rings = Array.from({ length: 9 }, (_, k) => {
      const angle = (Math.PI * k) / 8;
      return [centre, -r * Math.cos(angle), r * Math.sin(angle)];
    });
    return this.turned(rings, new THREE.Vector3(0, 0, 1), [node, node], centre, this.tinted("mass"), 16);
  }

  /** Put a shape on everything that moves; factor makes its greatest motion the size of the structure. */
  shape(real, imaginary, factor) {
    for (const { nodes, geometry } of this.moving) {
      const twin = nodes.length === 2 * geometry.attributes.position.count; // half-way between two nodes
      for (const [name, values] of [["re", real], ["im", imaginary]]) {
        const attribute = geometry.attributes[name], out = attribute.array;
        if (!values) out.fill(0);
        else if (twin)
          for (let v = 0; v < out.length / 3; v++)
            for (let k = 0; k < 3; k++)
              out[3 * v + k] = ((values[3 * nodes[2 * v] + k] + values[3 * nodes[2 * v + 1] + k]) / 2) * factor;
        else
          for (let v = 0; v < nodes.length; v++)
            for (let k = 0; k < 3; k++) out[3 * v + k] = values[3 * nodes[v] + k] * factor;
        attribute.needsUpdate = true;
      }
    }
  }

  dispose() {
    this.root.traverse((object) => {
      object.geometry?.dispose();
      object.material?.dispose();
    });
    this.markTexture.dispose();
    this.shared.scale.value.dispose();
  }
}

/** Where the eye is: a turntable about z, parallel projection, controlled by pointer and keyboard. */
class Eye {
  constructor(low, high) {
    this.low = low;
    this.high = high;
    this.size = low.distanceTo(high) || 1;
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 10);
    this.corner();
    this.aspect = 1;
  }

  corner() {
    [this.azimuth, this.elevation] = [-0.95, 0.42];
  }

  look(direction) {
    const views = { x: [0, 0], "-x": [Math.PI, 0], y: [Math.PI / 2, 0], "-y": [-Math.PI / 2, 0] };
    const flat = { z: [-Math.PI / 2, Math.PI / 2], "-z": [-Math.PI / 2, -Math.PI / 2] };
    if (direction === "corner") this.corner();
    else [this.azimuth, this.elevation] = { ...views, ...flat }[direction];
    this.fit();
  }

  /** Look at a box along a normal, from above where that is the question. */
  square(low, high, normal) {
    const [x, y, z] = normal, flat = Math.hypot(x, y), sense = z < -0.01 && flat < 0.1 ? -1 : 1;
    this.azimuth = flat < 1e-3 ? -Math.PI / 2 : Math.atan2(y, x);
    this.elevation = Math.atan2(sense * z, flat);
    this.fit(low, high);
  }

  axes() {
    const [a, e] = [this.azimuth, this.elevation];
    const back = new THREE.Vector3(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e));
    const right = new THREE.Vector3(-Math.sin(a), Math.cos(a), 0);
    return { back, right, up: back.clone().cross(right) };
  }

  fit(low = this.low, high = this.high) {
    this.target = low.clone().add(high).multiplyScalar(0.5);
    const { right, up } = this.axes();
    let [w, h] = [0, 0];
    for (let k = 0; k < 8; k++) {
      const corner = new THREE.Vector3(
        (k & 1 ? low : high).x, (k & 2 ? low : high).y, (k & 4 ? low : high).z,
      ).sub(this.target);
      w = Math.max(w, Math.abs(corner.dot(right)));
      h = Math.max(h, Math.abs(corner.dot(up)));
    }
    // room for what stands above and below, and for the motion
    const free = Math.max(0.45, 1 - OVERLAYS / (this.height || 1000));
    this.half = Math.max((1.15 * h) / free, (1.13 * w) / this.aspect, 1e-3 * this.size);
  }

  turn(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.elevation + dy));
  }

  pan(dx, dy) {
    const { right, up } = this.axes();
    this.target.addScaledVector(right, -dx * this.half).addScaledVector(up, dy * this.half);
  }

  /** Zoom about a place of the view, x and y from -1 to 1. */
  zoom(factor, x = 0, y = 0) {
    const half = Math.max(1e-4 * this.size, Math.min(20 * this.size, this.half * factor));
    const change = this.half - half, { right, up } = this.axes();
    this.target.addScaledVector(right, x * change * this.aspect).addScaledVector(up, y * change);
    this.half = half;
  }

  update() {
    const { back, right, up } = this.axes(), camera = this.camera, far = 3 * this.size;
    const place = this.target.clone().addScaledVector(back, far);
    const matrix = new THREE.Matrix4().makeBasis(right, up, back).setPosition(place);
    camera.matrixAutoUpdate = false;
    camera.matrix.copy(matrix);
    camera.matrixWorld.copy(matrix);
    camera.matrixWorldInverse.copy(matrix).invert();
    Object.assign(camera, {
      left: -this.half * this.aspect, right: this.half * this.aspect, top: this.half, bottom: -this.half,
      near: 0, far: 2 * far,
    });
    camera.updateProjectionMatrix();
  }
}

class View {
  constructor(element, scene, arrays, options) {
    this.scene = scene;
    this.options = options;
    this.arrays = arrays;
    this.cache = new Map();
    this.hidden = new Set();
    this.draws = 0;
    this.clean = [];
    this.selection = null;
    this.highlighted = [];
    style();
    const canvas = (this.canvas = document.createElement("canvas"));
    // smoothed edges cost a software renderer three times the work
    const antialias = arrays.triangles.length < 3 * SMOOTHED;
    const context = canvas.getContext("webgl2", { antialias, alpha: true });
    if (!context) throw new Error("WebGL 2 is not available");
    this.renderer = new THREE.WebGLRenderer({ canvas, context, antialias, alpha: true });
    this.renderer.setClearColor(0, 0);
    this.renderer.outputColorSpace = "srgb-linear"; // colours of the shaders are what is shown
    this.model = new Model(scene, arrays);
    const [low, high] = [new THREE.Vector3(), new THREE.Vector3()];
    const p = arrays.points;
    low.set(Infinity, Infinity, Infinity);
    high.set(-Infinity, -Infinity, -Infinity);
    for (let n = 0; n < p.length; n += 3) {
      low.set(Math.min(low.x, p[n]), Math.min(low.y, p[n + 1]), Math.min(low.z, p[n + 2]));
      high.set(Math.max(high.x, p[n]), Math.max(high.y, p[n + 1]), Math.max(high.z, p[n + 2]));
    }
    this.eye = new Eye(low, high);
    this.target = new THREE.WebGLRenderTarget(1, 1);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const modes = scene.modes && scene.loads.length ? scene.modes.frequencies[0].length : 0;
    this.state = {
      load: Math.max(0, scene.loads.length - 1), mode: modes ? 0 : null, phase: 0, amplitude: 0.06, speed: 0.6,
      playing: Boolean(modes) && !calm, field: modes ? "motion" : "parts", outline: Boolean(modes), fixings: true,
      names: !modes,
    };
    this.build(element);
    this.listen();
    this.theme();
  }

  /* ---- the page ---- */

  build(element) {
    this.element = element;
    element.replaceChildren();
    const stage = (this.stage = make("div", { class: "fv-stage" }, this.canvas));
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "application");
    this.canvas.setAttribute(
      "aria-label",
      `${this.scene.title}, 3-D view. Arrow keys turn, with Shift they move; plus and minus zoom; 0 fits; x, y, z look ` +
        "along an axis; space plays; n and p change the mode; Escape clears the selection.",
    );
    this.head = make("div", { class: "fv-over fv-head" });
    this.axes = make("div", { class: "fv-over fv-axes", "aria-hidden": "true" });
    this.scaleText = make("span");
    this.scaleLine = make("i");
    this.scale = make("div", { class: "fv-over fv-scale", "aria-hidden": "true" }, this.scaleText, this.scaleLine);
    this.barName = make("div");
    this.barLine = make("i");
    this.barLine.style.background = `linear-gradient(to right,${VIRIDIS.map(hex).join(",")})`;
    this.barEnds = [make("b"), make("b"), make("b")];
    for (const end of this.barEnds) end.style.fontWeight = "400";
    this.bar = make("div", { class: "fv-over fv-bar" }, this.barName, this.barLine, make("span", {}, ...this.barEnds));
    this.labels = make("div", { class: "fv-over", "aria-hidden": "true" });
    this.labels.style.inset = "0";
    stage.append(this.labels, this.head, this.axes, this.scale, this.bar);
    this.panel = make("div", { class: "fv-panel" });
    const all = make("div", { class: "fv-all" }, stage, this.panel);
    element.append(make("div", { class: "fv" }, all));
    this.controls();
    this.triad();
    this.named();
  }

  pickList(name, label, rows, chosen) {
    const select = make("select", { "aria-label": label, onchange: () => this.show({ [name]: chosen(select.value) }) });
    for (const [value, text] of rows) select.append(make("option", { value: String(value) }, text));
    this[`${name}Select`] = select;
    return make("div", {}, make("label", { class: "fv-top" }, make("span", {}, label)), select);
  }

  slider(name, label, given, text) {
    const out = make("output");
    const input = make("input", { type: "range", ...given, "aria-label": label, oninput: () => this.show({ [name]: Number(input.value) }) });
    this.sliders ??= {};
    this.sliders[name] = () => {
      if (Number(input.value) !== this.state[name]) input.value = String(this.state[name]);
      out.value = text(this.state[name]);
      input.setAttribute("aria-valuetext", out.value);
    };
    return make("div", {}, make("div", { class: "fv-top" }, make("span", {}, label), out), input);
  }

  check(label, checked, change, colour) {
    const input = make("input", { type: "checkbox", checked, onchange: () => change(input.checked) });
    const swatch = colour === undefined ? [] : [make("b")];
    if (swatch.length) swatch[0].style.background = hex(colour);
    const row = make("label", { class: "fv-check" }, input, ...swatch, make("span", {}, label));
    row.input = input;
    return row;
  }

  controls() {
    const { scene, panel } = this, { modes, loads } = scene;
    if (modes && loads.length) {
      panel.append(this.pickList("load", "Preload", loads.map((v, k) => [k, `${digits(v / 1e3)} kN`]), Number));
      panel.append(this.pickList("mode", "Mode", [], (value) => (value === "" ? null : Number(value))));
      this.playButton = make("button", { type: "button", onclick: () => this.show({ playing: !this.state.playing }) }, "Play");
      const step = (by) => () => this.step(by);
      panel.append(
        make("div", { class: "fv-row" },
          make("button", { type: "button", "aria-label": "Previous mode", onclick: step(-1) }, "‹"), this.playButton,
          make("button", { type: "button", "aria-label": "Next mode", onclick: step(1) }, "›")),
        this.slider("phase", "Phase", { min: "0", max: "360", step: "1" }, (v) => `${Math.round(v)}°`),
        this.slider("amplitude", "Amplitude", { min: "0", max: "0.2", step: "0.005" }, (v) => `${digits(100 * v, 3)} % of size`),
        this.slider("speed", "Speed", { min: "0.1", max: "3", step: "0.1" }, (v) => `${digits(v, 2)} cycles/s`),
      );
    } else if (scene.fields && Object.keys(scene.fields).length && loads.length) {
      panel.append(this.pickList("load", "Preload", loads.map((v, k) => [k, `${digits(v / 1e3)} kN`]), Number));
    }
    const fields = Object.entries(scene.fields).map(([name, field]) => [name, `${field.label} [${field.unit}]`]);
    if (modes || fields.length)
      panel.append(this.pickList("field", "Colour", [["parts", "parts"], ...(modes ? [["motion", "motion"]] : []), ...fields], String));
    this.joints();
    this.parts();
    this.extras();
    this.views();
    this.facts();
  }

  joints() {
    const named = this.scene.joints.filter((joint) => joint.faces.length);
    if (!named.length) return;
    const rows = [["", "whole structure"], ...named.map(({ name }) => [name, `joint ${name}`])];
    const select = (this.jointSelect = make("select", {
      "aria-label": "Look at", onchange: () => this.joint(select.value || null, { look: true }),
    }, ...rows.map(([value, text]) => make("option", { value }, text))));
    this.panel.append(make("div", {}, make("div", { class: "fv-top" }, make("span", {}, "Look at")), select));
  }

  parts() {
    const list = make("div", { class: "fv-list", tabindex: this.scene.parts.length > 6 ? "0" : "-1" });
    this.partChecks = this.scene.parts.map((part, k) => {
      const row = this.check(part.name, true, (on) => this.visible(part.name, on), PARTS[k % PARTS.length]);
      list.append(row);
      return row.input;
    });
    this.panel.append(make("fieldset", {}, make("legend", {}, "Parts"), list));
  }

  extras() {
    const { scene, state } = this, rows = [];
    const add = (name, label) => {
      const row = this.check(label, state[name], (on) => this.show({ [name]: on }));
      this[`${name}Check`] = row.input;
      rows.push(row);
    };
    if (scene.modes) add("outline", "Shape at rest");
    if (scene.bolts.length + scene.supports.length + scene.masses.length) add("fixings", "Bolts, supports, masses");
    if (scene.joints.length + scene.bolts.length) add("names", "Names");
    if (rows.length) this.panel.append(make("fieldset", {}, make("legend", {}, "Show"), ...rows));
  }

  views() {
    const button = (text, label, look) => make("button", { type: "button", "aria-label": label, onclick: look }, text);
    const along = (axis) => button(axis, `Look along ${axis}`, () => this.look(this.lastLook === axis ? `-${axis}` : axis));
    this.panel.append(
      make("div", { class: "fv-row", role: "group", "aria-label": "View" }, button("Fit", "Fit into the view", () => this.look("corner")),
        along("x"), along("y"), along("z")),
    );
  }

  facts() {
    const { scene } = this, limit = 3000;
    this.factLine = make("p", { class: "fv-facts", role: "status" });
    const box = make("div", {}, make("div", { class: "fv-top" }, make("span", {}, "Face")));
    if (scene.faces.length <= limit) {
      const select = (this.faceSelect = make("select", {
        "aria-label": "Face", onchange: () => this.chosen(select.value === "" ? null : Number(select.value)),
      }, make("option", { value: "" }, "none: click one, or choose")));
      scene.parts.forEach((part, k) => {
        const group = make("optgroup", { label: part.name });
        scene.faces.forEach((face, f) => {
          if (face.part === k) group.append(make("option", { value: String(f) }, face.name ? `${face.number} ${face.name}` : `face ${face.number}`));
        });
        select.append(group);
      });
      box.append(select);
    }
    box.append(this.factLine);
    this.panel.append(box);
  }

  triad() {
    const space = "http://www.w3.org/2000/svg", svg = document.createElementNS(space, "svg");
    svg.setAttribute("viewBox", "-42 -42 84 84");
    this.axisLines = ["#c8452f", "#3a8f3a", "#2f6fc8"].map((colour, k) => {
      const line = document.createElementNS(space, "line"), text = document.createElementNS(space, "text");
      line.setAttribute("stroke", colour);
      text.textContent = "xyz"[k];
      svg.append(line, text);
      return { line, text };
    });
    this.axes.append(svg);
  }

  named() {
    const { scene } = this;
    const middle = (a, b) => a.map((x, k) => (x + b[k]) / 2);
    const rows = [
      ...scene.joints.filter((j) => j.faces.length).map((j) => [j.name, scene.faces[j.faces[0]].centre, "joint"]),
      ...scene.bolts.map((b) => [b.name, b.meshed ? middle(...b.seats) : b.seats[0], "bolt"]),
      ...scene.supports.map((s) => [`${s.elastic ? "springs" : "fixed"} ${s.directions.join(" ")}`, scene.faces[s.face].centre, "support"]),
      ...scene.masses.map((m) => [`${digits(m.mass)} kg`, m.point, "mass"]),
    ];
    this.nameTags = rows.map(([text, at, kind]) => {
      const tag = make("span", { class: "fv-label" }, text);
      this.labels.append(tag);
      return { tag, at: new THREE.Vector3(...at), kind };
    });
  }

  /* ---- what people do ---- */

  on(target, kind, action, options) {
    target.addEventListener(kind, action, options);
    this.clean.push(() => target.removeEventListener(kind, action, options));
  }

  listen() {
    const { canvas, eye } = this, fingers = new Map();
    let moved = 0, spread = 0;
    const half = () => canvas.clientHeight / 2 || 1;
    this.on(canvas, "pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, event);
      moved = spread = 0;
    });
    this.on(canvas, "pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
      moved += Math.abs(dx) + Math.abs(dy);
      fingers.set(event.pointerId, event);
      if (fingers.size === 2) {
        const [a, b] = [...fingers.values()], now = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        if (spread) eye.zoom(spread / now);
        spread = now;
        eye.pan(dx / 2 / half(), dy / 2 / half());
      } else if (event.buttons & 6 || event.shiftKey) eye.pan(dx / half(), dy / half());
      else eye.turn(dx / 180, dy / 180);
      this.lastLook = null;
      this.redraw();
    });
    const release = (event) => {
      if (fingers.delete(event.pointerId) && moved < 4 && event.type === "pointerup" && event.button === 0)
        this.chosen(this.faceAt(event.offsetX, event.offsetY), this.reading(event.offsetX, event.offsetY));
    };
    this.on(canvas, "pointerup", release);
    this.on(canvas, "pointercancel", release);
    this.on(canvas, "contextmenu", (event) => event.preventDefault());
    this.on(canvas, "wheel", (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey && this.options.wheel === "focus") return; // the page scrolls
      event.preventDefault();
      const x = (2 * event.offsetX) / canvas.clientWidth - 1, y = 1 - (2 * event.offsetY) / canvas.clientHeight;
      eye.zoom(Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.003), x, y);
      this.redraw();
    }, { passive: false });
    this.on(canvas, "keydown", (event) => this.key(event));
    this.on(matchMedia("(prefers-color-scheme: dark)"), "change", () => this.theme());
    this.watcher = new ResizeObserver(() => this.resize());
    this.watcher.observe(this.stage);
    this.on(canvas, "webglcontextlost", (event) => event.preventDefault());
    this.on(canvas, "webglcontextrestored", () => this.redraw());
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const acts = {
      "+": () => this.eye.zoom(0.85), "=": () => this.eye.zoom(0.85), "-": () => this.eye.zoom(1 / 0.85),
      0: () => this.look("corner"), x: () => this.look("x"), y: () => this.look("y"), z: () => this.look("z"),
      X: () => this.look("-x"), Y: () => this.look("-y"), Z: () => this.look("-z"),
      " ": () => this.show({ playing: !this.state.playing }), n: () => this.step(1), p: () => this.step(-1),
      Escape: () => this.chosen(null),
    };
    if (arrows) event.shiftKey ? this.eye.pan(0.08 * arrows[0], 0.08 * arrows[1]) : this.eye.turn(0.09 * arrows[0], 0.09 * arrows[1]);
    else if (acts[event.key]) acts[event.key]();
    else return;
    event.preventDefault();
    this.redraw();
  }

  step(by) {
    if (this.state.mode === null && !this.scene.modes) return;
    const count = this.scene.modes.frequencies[this.state.load].length;
    this.show({ mode: this.state.mode === null ? 0 : (this.state.mode + by + count) % count });
  }

  chosen(face, reading = null) {
    this.selection = face;
    this.marked();
    const found = face === null ? null : this.describe(face);
    if (this.faceSelect) this.faceSelect.value = face === null ? "" : String(face);
    const field = reading && this.scene.fields[reading.field];
    const here = field ? `${field.label} here: ${digits(reading.value * field.factor, 3)} ${field.unit}. ` : "";
    this.factLine.textContent = found === null ? "" : here + this.words(found, face);
    this.options.onPick?.(found);
    this.redraw();
  }

  describe(face) {
    const { part, number, name, area, centre, normal } = this.scene.faces[face];
    return { part: this.scene.parts[part].name, number, name, area, centre, normal };
  }

  words({ part, number, name, area, centre, normal }, face) {
    const { unit, factor, joints } = this.scene;
    const place = centre.map((v) => digits(Math.abs(v * factor) < 1e-9 * this.scene.size * factor ? 0 : v * factor)).join(", ");
    const facing = Math.hypot(...normal) > 0.5 ? `, normal (${normal.map((v) => digits(Math.round(v * 1e3) / 1e3, 3)).join(", ")})` : "";
    const joined = joints.filter((j) => j.faces.includes(face)).map((j) => `, joint ${j.name}`).join("");
    return `${part}, face ${number}${name ? ` “${name}”` : ""}${joined}: area ${digits(area * factor ** 2)} ${unit}², centre (${place}) ${unit}${facing}`;
  }

  /* ---- what is shown ---- */

  async show(change = {}) {
    const { state, scene } = this;
    for (const [key, value] of Object.entries(change)) {
      if (!(key in state)) throw new Error(`show: no ${key}; there are ${Object.keys(state).join(", ")}`);
      if (value !== undefined) state[key] = value;
    }
    if (state.field !== "parts" && !(state.field in scene.fields) && !(state.field === "motion" && scene.modes)) state.field = "parts";
    if (!scene.modes || state.mode === null) state.playing = false;
    const wanted = scene.modes && state.mode !== null ? `${state.load}.${state.mode}` : null;
    if (wanted !== this.shaped) {
      this.shaped = wanted;
      await this.reshape(wanted);
    }
    const mapped = scene.fields[state.field] ? `${state.field}.${state.load}` : null;
    if (mapped !== this.mapped) {
      this.mapped = mapped;
      await this.remap();
    }
    this.dress();
    this.tell();
    this.redraw();
    this.options.onShow?.({ ...state });
  }

  async array(name) {
    const packed = this.scene.arrays[name];
    if (!packed) return null;
    if (!this.cache.has(name)) this.cache.set(name, unpacked(packed));
    return { values: await this.cache.get(name), scale: packed.scale };
  }

  async reshape(key) {
    const real = key && (await this.array(`real.${key}`)), imaginary = key && (await this.array(`imaginary.${key}`));
    if (key !== this.shaped) return; // another was asked for meanwhile
    let peak = 0;
    if (real) {
      const [r, i] = [real.values, imaginary?.values];
      for (let n = 0; n < r.length; n += 3) {
        let square = r[n] ** 2 + r[n + 1] ** 2 + r[n + 2] ** 2;
        if (i) square += i[n] ** 2 + i[n + 1] ** 2 + i[n + 2] ** 2;
        if (square > peak) peak = square;
      }
      peak = Math.sqrt(peak);
    }
    const factor = peak ? this.scene.size / peak : 0;
    this.shapeNow = { real: real?.values, imaginary: imaginary?.values, factor };
    this.model.shape(real?.values, imaginary?.values, factor);
  }

  async remap() {
    const { state, scene, model } = this, field = scene.fields[state.field];
    model.shared.least.value = CARRIED.includes(state.field) ? 0.015 : -1;
    for (const [k, joint] of scene.joints.entries()) {
      const mesh = model.maps[k], array = field && joint.map !== null && (await this.array(`${joint.map}.${state.field}`));
      if (!mesh || !array) continue;
      const count = mesh.geometry.attributes.position.count, rows = array.values.length / count;
      const begin = count * Math.min(state.load, rows - 1), [low, high] = field.range;
      const out = mesh.geometry.attributes.value;
      for (let v = 0; v < count; v++) out.array[v] = (array.values[begin + v] - low) / (high - low || 1);
      out.needsUpdate = true;
      mesh.userData.mapped = true;
    }
  }

  /** Materials and visibility from the state. */
  dress() {
    const { state, scene, model } = this, field = scene.fields[state.field], ghost = Boolean(field);
    const moving = state.mode !== null && Boolean(scene.modes), theme = THEMES[this.themeName];
    scene.parts.forEach((part, k) => {
      const mesh = model.parts[k], on = !this.hidden.has(part.name), { uniforms } = mesh.material;
      mesh.visible = on;
      uniforms.kind.value = state.field === "motion" && moving ? 1 : 0;
      uniforms.alpha.value = ghost ? 0.16 : 1;
      mesh.material.transparent = ghost;
      mesh.material.depthWrite = !ghost;
      mesh.renderOrder = ghost ? 2 : 0;
      const { moved, rest } = model.edges[k];
      moved.visible = on;
      moved.material.uniforms.tint.value = rgb(ghost ? theme.rest : theme.edge);
      moved.renderOrder = 1;
      rest.visible = on && state.outline && moving && state.amplitude > 0;
      rest.material.uniforms.tint.value = rgb(theme.rest);
      rest.material.uniforms.alpha.value = 0.75;
    });
    scene.joints.forEach((joint, k) => {
      const mesh = model.maps[k];
      if (mesh) mesh.visible = ghost && this.scene.arrays[`${joint.map}.${state.field}`] !== undefined;
    });
    const tint = (mesh, name) => {
      if (!mesh) return;
      mesh.visible = state.fixings;
      mesh.material.uniforms.tint.value = rgb(theme[name]);
      mesh.material.uniforms.alpha.value = ghost ? 0.3 : 1; // heads do not hide the maps below them
      mesh.material.transparent = ghost;
      mesh.material.depthWrite = !ghost;
    };
    model.bolts.forEach((mesh) => tint(mesh, "bolt"));
    model.supports.flat().forEach((mesh) => tint(mesh, "support"));
    model.masses.forEach((mesh) => tint(mesh, "mass"));
    this.labels.classList.toggle("fv-hidden", !state.names);
    for (const { tag, kind } of this.nameTags) tag.classList.toggle("fv-hidden", kind !== "joint" && !state.fixings);
  }

  /** Texts and controls from the state. */
  tell() {
    const { state, scene } = this, { modes, loads } = scene, field = scene.fields[state.field];
    const lines = [];
    if (modes && state.mode !== null) {
      const f = modes.frequencies[state.load][state.mode], eta = modes.loss_factors[state.load][state.mode];
      lines.push(`Mode ${state.mode + 1}: ${digits(f, 5)} Hz`, [`preload ${digits(loads[state.load] / 1e3)} kN`, eta === null ? "no loss predicted" : `loss factor ${digits(eta, 3)}`, ...(scene.arrays[`real.${state.load}.${state.mode}`] ? [] : ["shape left out of this page for its size"])].join(", "));
    } else if (field && loads.length) lines.push("", `preload ${digits(loads[state.load] / 1e3)} kN`);
    this.head.replaceChildren(...(lines.length ? [make("strong", {}, lines[0]), make("div", {}, lines[1])] : []));
    if (this.modeSelect) {
      const rows = modes.frequencies[state.load].map((f, k) => `${k + 1}:  ${digits(f, 5)} Hz`);
      if (this.modeSelect.options.length !== rows.length + 1 || this.modesOf !== state.load) {
        this.modeSelect.replaceChildren(make("option", { value: "" }, "at rest"), ...rows.map((text, k) => make("option", { value: String(k) }, text)));
        this.modesOf = state.load;
      }
      this.modeSelect.value = state.mode === null ? "" : String(state.mode);
      this.playButton.textContent = state.playing ? "Pause" : "Play";
      this.playButton.disabled = state.mode === null;
      for (const update of Object.values(this.sliders)) update();
    }
    if (this.loadSelect) this.loadSelect.value = String(state.load);
    if (this.fieldSelect) this.fieldSelect.value = state.field;
    for (const name of ["outline", "fixings", "names"]) if (this[`${name}Check`]) this[`${name}Check`].checked = state[name];
    const motion = state.field === "motion" && state.mode !== null;
    this.bar.classList.toggle("fv-hidden", !field && !motion);
    if (field) {
      this.barName.textContent = `${field.label} [${field.unit}]${CARRIED.includes(state.field) ? ", grey: open" : ""}`;
      const [low, high] = field.range;
      [low, (low + high) / 2, high].forEach((v, k) => (this.barEnds[k].textContent = digits(v * field.factor, 3)));
    } else if (motion) {
      this.barName.textContent = "motion, relative to the greatest";
      ["0", "0.5", "1"].forEach((text, k) => (this.barEnds[k].textContent = text));
    }
  }

  marked() {
    const { marks, markTexture } = this.model;
    marks.fill(0);
    for (const face of this.highlighted) marks[4 * face] = 200;
    if (this.selection !== null) marks[4 * this.selection] = 255;
    markTexture.needsUpdate = true;
  }

  find(part, number) {
    const found = this.scene.faces.findIndex((face) => face.number === number && this.scene.parts[face.part].name === part);
    if (found < 0) throw new Error(`no face ${number} of ${part}`);
    return found;
  }

  select(part, number) {
    this.chosen(part === null || part === undefined ? null : this.find(part, number));
  }

  highlight(faces) {
    this.highlighted = faces.map(({ part, number }) => this.find(part, number));
    this.marked();
    this.redraw();
  }

  joint(name, { look = false } = {}) {
    const found = name === null ? undefined : this.scene.joints.find((joint) => joint.name === name);
    if (name !== null && !found) throw new Error(`no joint ${name}`);
    this.highlighted = [...(found?.faces ?? [])];
    if (this.jointSelect) this.jointSelect.value = name ?? "";
    if (look && found?.faces.length) this.eye.square(...this.around(found.faces));
    else if (look) this.eye.look("corner");
    this.marked();
    this.redraw();
  }

  /** The box around some faces and the normal of the first. */
  around(faces) {
    const { points, triangles, face_of_triangle: faceOf } = this.arrays, wanted = new Set(faces);
    const [low, high] = [new THREE.Vector3(Infinity, Infinity, Infinity), new THREE.Vector3(-Infinity, -Infinity, -Infinity)];
    for (let k = 0; k < triangles.length; k++) {
      if (!wanted.has(faceOf[Math.floor(k / 3)])) continue;
      const at = new THREE.Vector3().fromArray(points, 3 * triangles[k]);
      low.min(at);
      high.max(at);
    }
    return [low, high, this.scene.faces[faces[0]].normal];
  }

  visible(part, on) {
    const k = this.scene.parts.findIndex(({ name }) => name === part);
    if (k < 0) throw new Error(`no part ${part}`);
    on ? this.hidden.delete(part) : this.hidden.add(part);
    this.partChecks[k].checked = on;
    this.dress();
    this.redraw();
  }

  hide(part) {
    this.visible(part, false);
  }

  unhide(part) {
    this.visible(part, true);
  }

  look(direction) {
    this.lastLook = direction;
    this.eye.look(direction);
    this.redraw();
  }

  theme() {
    this.themeName = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
    this.dress();
    this.redraw();
  }

  /* ---- drawing ---- */

  resize() {
    const { clientWidth: w, clientHeight: h } = this.stage;
    if (!w || !h) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio || 1));
    this.renderer.setSize(w, h, false);
    const first = !this.sized, before = this.eye.aspect;
    this.eye.aspect = w / h;
    this.eye.height = h;
    if (first || Math.abs(before / this.eye.aspect - 1) > 0.2) this.eye.fit();
    this.sized = true;
    this.draw();
  }

  redraw() {
    if (this.waiting || this.gone) return;
    this.waiting = requestAnimationFrame((now) => {
      this.waiting = 0;
      if (this.state.playing && !document.hidden) {
        const past = Math.min(0.25, (now - (this.last ?? now)) / 1e3);
        this.state.phase = (this.state.phase + 360 * this.state.speed * past) % 360;
        this.sliders?.phase();
      }
      this.last = now;
      this.draw();
      if (this.state.playing) this.redraw();
      else this.last = undefined;
    });
  }

  /** Phase, amplitude and camera as they are now. */
  pose() {
    const { shared } = this.model, angle = (this.state.phase * Math.PI) / 180;
    shared.amp.value = this.state.mode === null ? 0 : this.state.amplitude;
    shared.co.value = Math.cos(angle);
    shared.si.value = Math.sin(angle);
    this.eye.update();
  }

  draw() {
    if (!this.sized || this.gone) return;
    this.pose();
    this.renderer.render(this.model.root, this.eye.camera);
    this.overlay();
    this.draws += 1;
  }

  overlay() {
    const { right, up, back } = this.eye.axes();
    this.axisLines.forEach(({ line, text }, k) => {
      const axis = new THREE.Vector3(k === 0, k === 1, k === 2), x = axis.dot(right), y = -axis.dot(up);
      line.setAttribute("x2", String(25 * x));
      line.setAttribute("y2", String(25 * y));
      text.setAttribute("x", String(34 * x));
      text.setAttribute("y", String(34 * y));
      text.setAttribute("opacity", axis.dot(back) > 0.97 || axis.dot(back) < -0.97 ? "0" : "1");
    });
    const pixel = (2 * this.eye.half) / (this.stage.clientHeight || 1), { unit, factor } = this.scene;
    const wanted = 110 * pixel * factor, power = 10 ** Math.floor(Math.log10(wanted));
    const length = power * [5, 2, 1].find((step) => step * power <= wanted);
    this.scaleText.textContent = `${digits(length)} ${unit}`;
    this.scaleLine.style.width = `${length / factor / pixel}px`;
    if (!this.state.names) return;
    const taken = [];
    for (const { tag, at } of this.nameTags) {
      if (tag.classList.contains("fv-hidden")) continue;
      let { x, y } = this.project(at);
      while (taken.some((other) => Math.abs(other.x - x) < 70 && Math.abs(other.y - y) < 17)) y += 18;
      taken.push({ x, y });
      tag.style.transform = `translate(${Math.round(x)}px,${Math.round(y)}px) translate(-50%,-50%)`;
    }
  }

  project(point) {
    const at = Array.isArray(point) ? new THREE.Vector3(...point) : point.clone();
    this.eye.update();
    at.applyMatrix4(this.eye.camera.matrixWorldInverse).applyMatrix4(this.eye.camera.projectionMatrix);
    return { x: ((at.x + 1) / 2) * this.stage.clientWidth, y: ((1 - at.y) / 2) * this.stage.clientHeight };
  }

  /* ---- what is asked ---- */

  /** Position in scene.faces of the face at a place of the canvas, null beside all. */
  faceAt(x, y) {
    const { model, renderer, eye, target } = this, { clientWidth: w, clientHeight: h } = this.stage;
    const solid = new Set(model.parts.filter((mesh) => mesh.visible));
    const seen = model.maps.filter((mesh) => mesh?.visible);
    if (seen.length) solid.clear(); // parts are transparent then
    seen.forEach((mesh) => solid.add(mesh));
    const kept = model.root.children.map((object) => [object, object.visible, object.material]);
    for (const [object] of kept) {
      object.visible = solid.has(object);
      object.material = model.pickMaterial;
    }
    this.pose();
    eye.camera.setViewOffset(w, h, Math.floor(x), Math.floor(y), 1, 1);
    renderer.setRenderTarget(target);
    renderer.clear();
    renderer.render(model.root, eye.camera);
    const rgba = new Uint8Array(4);
    renderer.readRenderTargetPixels(target, 0, 0, 1, 1, rgba);
    renderer.setRenderTarget(null);
    eye.camera.clearViewOffset();
    for (const [object, visible, material] of kept) Object.assign(object, { visible, material });
    return rgba[3] ? rgba[0] + 256 * rgba[1] + 65536 * rgba[2] - 1 : null;
  }

  pick(x, y) {
    const face = this.faceAt(x, y);
    return face === null || face < 0 ? null : this.describe(face);
  }

  /** What a map shows at a place of the canvas: {joint, field, value [SI]}; null where there is none. */
  reading(x, y) {
    const { scene, model, state } = this, field = scene.fields[state.field], angle = (state.phase * Math.PI) / 180;
    if (!field) return null;
    const size = state.mode === null ? 0 : state.amplitude, [c, s] = [size * Math.cos(angle), size * Math.sin(angle)];
    let found = null, nearest = Infinity;
    this.eye.update();
    const matrix = new THREE.Matrix4().multiplyMatrices(this.eye.camera.projectionMatrix, this.eye.camera.matrixWorldInverse);
    const { clientWidth: w, clientHeight: h } = this.stage, at = new THREE.Vector3();
    scene.joints.forEach((joint, k) => {
      const mesh = model.maps[k];
      if (!mesh?.visible) return;
      const { position, re, im, value } = mesh.geometry.attributes, index = mesh.geometry.index.array;
      const seen = new Float64Array(3 * position.count);
      for (let v = 0; v < position.count; v++) {
        const [X, Y, Z] = [0, 1, 2].map((j) => position.array[3 * v + j] + c * re.array[3 * v + j] - s * im.array[3 * v + j]);
        at.set(X, Y, Z).applyMatrix4(matrix);
        seen.set([((at.x + 1) / 2) * w - x, ((1 - at.y) / 2) * h - y, at.z], 3 * v);
      }
      for (let t = 0; t < index.length; t += 3) {
        const [a, b, d] = [index[t], index[t + 1], index[t + 2]];
        const cross = (p, q) => seen[3 * p] * seen[3 * q + 1] - seen[3 * p + 1] * seen[3 * q];
        const parts = [cross(b, d), cross(d, a), cross(a, b)], whole = parts[0] + parts[1] + parts[2];
        if (!whole || parts.some((part) => part / whole < -1e-9)) continue;
        const mean = (of) => (parts[0] * of(a) + parts[1] * of(b) + parts[2] * of(d)) / whole;
        const depth = mean((v) => seen[3 * v + 2]);
        if (depth >= nearest) continue;
        nearest = depth;
        const share = mean((v) => value.array[v]), [low, high] = field.range;
        found = { joint: joint.name, field: state.field, value: low + share * (high - low) };
      }
    });
    return found;
  }

  positions(part) {
    const k = this.scene.parts.findIndex(({ name }) => name === part);
    if (k < 0) throw new Error(`no part ${part}`);
    const { nodes } = this.model.parts[k].userData, { real, imaginary, factor } = this.shapeNow ?? {};
    const positions = new Float32Array(3 * nodes.length), angle = (this.state.phase * Math.PI) / 180;
    const size = real ? this.state.amplitude * factor : 0, [c, s] = [Math.cos(angle) * size, Math.sin(angle) * size];
    nodes.forEach((node, v) => {
      for (let j = 0; j < 3; j++) {
        const at = 3 * node + j;
        positions[3 * v + j] = this.arrays.points[at] + (real ? c * real[at] : 0) - (imaginary ? s * imaginary[at] : 0);
      }
    });
    return { nodes, positions };
  }

  pixels() {
    this.draw();
    const gl = this.renderer.getContext(), { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
    const data = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
    return { width, height, data };
  }

  dispose() {
    this.gone = true;
    cancelAnimationFrame(this.waiting);
    this.watcher.disconnect();
    for (const undo of this.clean) undo();
    this.model.dispose();
    this.target.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.element.replaceChildren();
  }
}

/** Show a scene in an element; see the top of this file. */
export async function mount(element, scene, options = {}) {
  if (scene.format !== "faying-scene" || scene.version !== 1) throw new Error("not a scene that this viewer reads");
  const names = Object.keys(scene.arrays).filter((name) => !/^(real|imaginary)\./.test(name));
  const found = await Promise.all(names.map((name) => unpacked(scene.arrays[name])));
  const arrays = Object.fromEntries(names.map((name, k) => [name, found[k]]));
  const view = new View(element, scene, arrays, options);
  await view.show({});
  view.resize();
  return view;
}
