// Shows a world that is in the page as a GLB: turn about it, walk in it, open what opens, day and night.
import {
  ACESFilmicToneMapping, AmbientLight, Box3, Clock, Color, DirectionalLight, HemisphereLight, MathUtils, PCFSoftShadowMap,
  PerspectiveCamera, PMREMGenerator, Quaternion, Raycaster, Scene, SRGBColorSpace, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const EYE_M = 1.6;
const WALK_M_S = 1.8;
const ELBOW_M = 0.25;
const LAMPS = 8;
const element = (id) => document.getElementById(id);
const say = (text) => { element('about').textContent = text; };
const HINT = 'Drag to turn, wheel to zoom, right button to move. Click a door or a drawer to open it.';
const WALK_HINT = 'Arrow keys or W A S D to walk, drag to look around. Click a door or a drawer to open it.';

const bytes = Uint8Array.from(atob(element('world').textContent), (c) => c.charCodeAt(0));
const renderer = new WebGLRenderer({ antialias: true });
renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
renderer.toneMapping = ACESFilmicToneMapping;
renderer.outputColorSpace = SRGBColorSpace;
renderer.shadowMap.enabled = true;
renderer.shadowMap.type = PCFSoftShadowMap;
renderer.domElement.tabIndex = 0;
renderer.domElement.setAttribute('aria-label', 'World in three dimensions');
document.body.prepend(renderer.domElement);

const scene = new Scene();
scene.environment = new PMREMGenerator(renderer).fromScene(new RoomEnvironment(), 0.04).texture;
const camera = new PerspectiveCamera(50, 1, 0.05, 2000);
const orbit = new OrbitControls(camera, renderer.domElement);
orbit.enableDamping = true;
orbit.maxPolarAngle = Math.PI * 0.495;
const sky = new HemisphereLight(0xdfeaff, 0x8a8378, 1.0);
const sun = new DirectionalLight(0xfff2df, 2.6);
const dim = new AmbientLight(0xffffff, 0.15);
sun.castShadow = true;
sun.shadow.mapSize.set(4096, 4096);
sun.shadow.bias = -0.0004;
sun.shadow.normalBias = 0.03;
scene.add(sky, sun, sun.target, dim);

const parts = { layers: new Map(), joints: [], lamps: [], rooms: [], solid: [] };
const state = { walk: false, ceiling: false, night: false, storey: '', yaw: 0, pitch: -0.1, keys: new Set(), moving: new Set() };

new GLTFLoader().parse(bytes.buffer, '', (gltf) => {
  scene.add(gltf.scene);
  gltf.scene.traverse(sortIn);
  const box = new Box3();
  parts.rooms.forEach((room) => box.expandByObject(room));
  if (box.isEmpty()) box.setFromObject(gltf.scene);
  frame(box);
  fillLists();
  refresh();
  say(HINT);
  renderer.setAnimationLoop(draw);
  // For tests and for those who script the page.
  window.d3dgen = { scene, camera, parts, state, toggle, ready: true };
}, (error) => say(`The world cannot be read: ${error.message}`));

function sortIn(node) {
  const facts = node.userData;
  if (facts.layer) parts.layers.set(facts.layer, [...(parts.layers.get(facts.layer) ?? []), node]);
  if (facts.category === 'room') parts.rooms.push(node);
  if (facts.joint) parts.joints.push(rest(node, facts.joint));
  if (node.isPointLight) parts.lamps.push({ node, strength: node.intensity });
  if (node.isDirectionalLight) node.visible = false; // ours casts shadows
  if (node.isMesh) {
    const clear = node.material.transparent;
    node.castShadow = !clear;
    node.receiveShadow = !clear;
    node.material.envMapIntensity = 0.45;
    parts.solid.push(node);
  }
}

function rest(node, joint) {
  const limits = joint.limits_rad ?? joint.limits_m ?? [0, 0];
  const open = Math.abs(limits[1]) >= Math.abs(limits[0]) ? limits[1] : limits[0];
  return { node, name: joint.name, slides: joint.kind === 'prismatic', axis: new Vector3(...joint.axis), open, at: 0, to: 0,
    position: node.position.clone(), turn: node.quaternion.clone() };
}

/** Opens what is shut and shuts what is open of this name. */
function toggle(name, open) {
  const group = parts.joints.filter((j) => j.name === name);
  const to = open ?? (group.some((j) => j.to > 0.5) ? 0 : 1);
  group.forEach((j) => { j.to = to; state.moving.add(j); });
}

function move(joint, seconds) {
  const step = seconds / 0.9;
  joint.at = joint.at < joint.to ? Math.min(joint.to, joint.at + step) : Math.max(joint.to, joint.at - step);
  const eased = joint.at * joint.at * (3 - 2 * joint.at) * joint.open;
  if (joint.slides) {
    joint.node.position.copy(joint.position).add(joint.axis.clone().multiplyScalar(eased).applyQuaternion(joint.turn));
  } else {
    joint.node.quaternion.copy(joint.turn).multiply(new Quaternion().setFromAxisAngle(joint.axis, eased));
  }
  if (joint.at === joint.to) state.moving.delete(joint);
}

function frame(box) {
  const size = box.getSize(new Vector3());
  const middle = box.getCenter(new Vector3());
  const radius = Math.max(size.x, size.z, 4) / 2;
  const far = (1.25 * radius) / Math.tan(MathUtils.degToRad(camera.fov / 2));
  camera.position.set(middle.x + 0.35 * far, middle.y + 0.95 * far, middle.z + 0.62 * far);
  orbit.target.copy(middle).setY(box.min.y);
  sun.position.set(middle.x - radius * 1.2, box.max.y + 2.4 * radius, middle.z + radius * 1.1);
  sun.target.position.copy(middle);
  const reach = 1.6 * radius;
  Object.assign(sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.5, far: 8 * radius });
}

function fillLists() {
  const storeys = [...parts.layers.keys()].filter((k) => k.startsWith('storey_')).sort((a, b) => a.slice(7) - b.slice(7));
  element('storey').hidden = storeys.length < 2;
  element('storey').append(new Option('All storeys', ''), ...storeys.map((s) => new Option(`Up to storey ${s.slice(7)}`, s)));
  const named = parts.rooms.map((r) => new Option(r.userData.label ?? r.name, r.name));
  element('room').append(...named.sort((a, b) => a.text.localeCompare(b.text)));
}

function refresh() {
  const inside = state.walk || state.ceiling;
  for (const [layer, nodes] of parts.layers) {
    const above = layer.startsWith('storey_') && state.storey && Number(layer.slice(7)) > Number(state.storey.slice(7));
    nodes.forEach((n) => { n.visible = layer === 'ceiling' ? inside : !above; });
  }
  sky.intensity = state.night ? 0.05 : 0.65;
  dim.intensity = state.night ? 0.08 : 0.15;
  sun.intensity = state.night ? 0 : 2.6;
  scene.environmentIntensity = state.night ? 0.08 : 0.5;
  scene.background = new Color(state.night ? 0x0a0f1a : 0xe6edf3);
  renderer.toneMappingExposure = state.night ? 1.15 : 0.9;
  for (const [id, on] of [['walk', state.walk], ['ceiling', inside], ['night', state.night]]) {
    element(id).setAttribute('aria-pressed', on);
  }
  orbit.enabled = !state.walk;
  camera.fov = state.walk ? 70 : 50;
  camera.updateProjectionMatrix();
}

/** Lights the lamps nearest to what is looked at: a browser has no room for hundreds. */
function light() {
  const here = state.walk ? camera.position : orbit.target;
  const place = new Vector3();
  parts.lamps.forEach((l) => { l.far = l.node.getWorldPosition(place).distanceToSquared(here); });
  [...parts.lamps].sort((a, b) => a.far - b.far).forEach((l, i) => {
    l.node.visible = i < LAMPS;
    l.node.intensity = l.strength * (state.night ? 0.05 : 0.012);
    l.node.distance = 9;
  });
}

/** Returns the height of the floor of a room. */
parts.storeyOf = (room) => {
  for (let o = room; o; o = o.parent) if (o.userData.elevation_m !== undefined) return o.userData.elevation_m;
  return 0;
};

function walkTo(name) {
  const room = parts.rooms.find((r) => r.name === name);
  if (!room) return;
  const box = new Box3().setFromObject(room);
  const middle = box.getCenter(new Vector3());
  const size = box.getSize(new Vector3());
  // At one end of its longer side, looking along it.
  const along = size.x > size.z ? 'x' : 'z';
  middle[along] -= 0.3 * size[along];
  state.yaw = along === 'x' ? -Math.PI / 2 : Math.PI;
  state.pitch = -0.12;
  const floor = parts.storeyOf(room);
  camera.position.set(middle.x, floor + EYE_M, middle.z);
  state.walk = true;
  say(WALK_HINT);
  refresh();
}

const ray = new Raycaster();
function walk(seconds) {
  const pressed = (...names) => names.some((n) => state.keys.has(n));
  const ahead = pressed('w', 'arrowup') - pressed('s', 'arrowdown');
  const aside = pressed('d') - pressed('a');
  state.yaw += (pressed('arrowleft') - pressed('arrowright')) * 1.6 * seconds;
  const way = new Vector3(aside, 0, -ahead).applyAxisAngle(new Vector3(0, 1, 0), state.yaw);
  const length = way.length();
  if (length > 0) {
    way.divideScalar(length);
    const step = WALK_M_S * seconds;
    const from = camera.position.clone().setY(camera.position.y - 0.6);
    ray.set(from, way);
    ray.far = step + ELBOW_M;
    if (!ray.intersectObjects(parts.solid, false).some((h) => visible(h.object))) camera.position.addScaledVector(way, step);
  }
  camera.quaternion.setFromAxisAngle(new Vector3(0, 1, 0), state.yaw)
    .multiply(new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), state.pitch));
}

function visible(object) {
  for (let o = object; o; o = o.parent) if (!o.visible) return false;
  return true;
}

const clock = new Clock();
let tick = 0;
function draw() {
  const seconds = Math.min(clock.getDelta(), 0.1);
  state.moving.forEach((j) => move(j, seconds));
  if (state.walk) walk(seconds); else orbit.update();
  if (tick++ % 20 === 0) light();
  renderer.render(scene, camera);
}

function resize() {
  renderer.setSize(innerWidth, innerHeight);
  camera.aspect = innerWidth / innerHeight;
  camera.updateProjectionMatrix();
}
addEventListener('resize', resize);
resize();

let pressed = null;
renderer.domElement.addEventListener('pointerdown', (e) => { pressed = { x: e.clientX, y: e.clientY, moved: 0 }; });
renderer.domElement.addEventListener('pointermove', (e) => {
  if (!pressed) return;
  pressed.moved += Math.abs(e.movementX) + Math.abs(e.movementY);
  if (!state.walk) return;
  state.yaw += e.movementX * 0.004;
  state.pitch = MathUtils.clamp(state.pitch + e.movementY * 0.004, -1.3, 1.3);
});
addEventListener('pointerup', (e) => {
  const click = pressed && pressed.moved < 5 && e.target === renderer.domElement;
  pressed = null;
  if (click) touch(e);
});

function touch(e) {
  const at = new Vector2((e.clientX / innerWidth) * 2 - 1, 1 - (e.clientY / innerHeight) * 2);
  ray.setFromCamera(at, camera);
  ray.far = Infinity;
  const hit = ray.intersectObjects(parts.solid, false).find((h) => visible(h.object));
  if (!hit) return;
  const chain = [];
  for (let o = hit.object; o; o = o.parent) chain.push(o);
  const joint = chain.find((o) => o.userData.joint);
  if (joint) toggle(joint.userData.joint.name);
  const known = chain.find((o) => o.userData.category);
  if (known) say([known.name, known.userData.label ?? known.userData.class ?? known.userData.category].join(' · '));
}

addEventListener('keydown', (e) => {
  if (e.target.tagName === 'SELECT') return;
  state.keys.add(e.key.toLowerCase());
  if (e.key.startsWith('Arrow') && state.walk) e.preventDefault();
});
addEventListener('keyup', (e) => state.keys.delete(e.key.toLowerCase()));
addEventListener('blur', () => state.keys.clear());

element('walk').onclick = () => {
  if (state.walk) {
    state.walk = false;
    say(HINT);
    refresh();
  } else {
    const middle = orbit.target;
    const near = (r) => new Box3().setFromObject(r).getCenter(new Vector3()).distanceTo(middle);
    const [first] = [...parts.rooms].sort((a, b) => near(a) - near(b));
    if (first) walkTo(first.name);
  }
};
element('ceiling').onclick = () => { state.ceiling = !state.ceiling; refresh(); };
element('night').onclick = () => { state.night = !state.night; refresh(); };
element('storey').onchange = (e) => { state.storey = e.target.value; refresh(); };
element('room').onchange = (e) => { walkTo(e.target.value); e.target.value = ''; e.target.blur(); };
element('doors').onclick = (e) => {
  const open = e.target.getAttribute('aria-pressed') !== 'true';
  e.target.setAttribute('aria-pressed', open);
  const doors = new Set(parts.joints.filter((j) => j.node.userData.category === 'leaf').map((j) => j.name));
  doors.forEach((name) => toggle(name, open ? 1 : 0));
};
