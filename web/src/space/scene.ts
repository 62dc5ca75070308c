/** The view in space: looks, walks, opens doors, tells what was pointed at. Drawn only when something changes. */
import {
  AmbientLight,
  Box3,
  BufferGeometry,
  Color,
  DirectionalLight,
  HemisphereLight,
  type Intersection,
  Mesh,
  type Object3D,
  PerspectiveCamera,
  PointLight,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { acceleratedRaycast, MeshBVH } from "three-mesh-bvh";

import type { World } from "../gen/d3dgen/v1/world_pb";
import { type Bodies, bodiesOf } from "./build";
import { corners, inside, reach } from "../lib/geometry";
import { objectOf, roomOf } from "../lib/world";
import { furnish, jointOf, movingParts } from "./models";

Mesh.prototype.raycast = acceleratedRaycast;

const EYES = 1.6;
/** Who walks is so wide, m, and so fast, m/s. */
const WALKER = { radius: 0.22, speed: 1.6, knees: 0.35 };
/** How long a door takes to open, s, and how near who walks has to be, m. */
const DOOR = { time: 0.5, near: 1.4 };
/** From where a single thing is looked at: so far before its front, and so many of its own lengths more, so high above its middle, m. */
const LOOK = { near: 0.5, lengths: 1.4, above: 0.7 };
/** From which side a whole storey is looked at, and how much of the picture it fills at most. */
const ABOVE = new Vector3(-0.2, -0.65, 1).normalize();
const FILLED = 0.94;
const FARTHEST = 450;
const LIGHTS = 12;
const SKY = { day: "#dfe9ee", night: "#10151c" };
const WAYS: Record<string, [number, number]> = {
  w: [1, 0],
  ArrowUp: [1, 0],
  s: [-1, 0],
  ArrowDown: [-1, 0],
  a: [0, 1],
  ArrowLeft: [0, 1],
  d: [0, -1],
  ArrowRight: [0, -1],
};

/** What was pointed at. */
export interface Picked {
  objectId?: string;
  doorId?: string;
  roomId?: string;
  /** Name of the part of the object that moves. */
  part?: string;
}

/** Something that opens: a leaf of a door, or a part of a thing. */
interface Opening {
  /** Id of the door, or of the thing and its part; leaves of one door share it. */
  id: string;
  set(open: number): void;
}

const partId = (placementId: string, part: string) => `${placementId}/${part}`;

export class SpaceView {
  #renderer: WebGLRenderer;
  #scene = new Scene();
  #camera = new PerspectiveCamera(55, 1, 0.05, 500);
  #controls: OrbitControls;
  #bodies: Bodies | undefined;
  #collider: MeshBVH | undefined;
  #openings: Opening[] = [];
  /** How far each opening is, and is to be, by its id. */
  #open = new Map<string, { now: number; wished: number }>();
  #keys = new Set<string>();
  #walking = false;
  #eyes = EYES;
  #heading = 0;
  #pitch = 0;
  #asked = false;
  #last = 0;
  #over = false;
  #sun = new DirectionalLight("#fff8ec", 1.4);
  #hemisphere = new HemisphereLight("#ffffff", "#d9d4c8", 2.2);
  #ambient = new AmbientLight("#8fa0c8", 0);
  #lamps: PointLight[] = [];
  #resize: ResizeObserver;

  /** Called when something begins to open or shut, with the ids of all that is to be open. */
  onopen: (ids: string[]) => void = () => {};
  /** Called when models have come, whose parts can be moved from now on. */
  onmodels: () => void = () => {};

  /**
   * Puts a canvas into an element.
   *
   * Throws when the browser has no WebGL.
   */
  constructor(private element: HTMLElement) {
    // what is drawn stays readable for pictures of the page
    this.#renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    element.append(this.#renderer.domElement);
    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, this.#renderer.domElement);
    this.#controls.maxPolarAngle = Math.PI * 0.495;
    this.#controls.addEventListener("change", () => this.#ask());
    this.#sun.position.set(-6, -9, 14);
    this.#scene.add(this.#sun, this.#hemisphere, this.#ambient);
    this.#resize = new ResizeObserver(() => this.#fit());
    this.#resize.observe(element);
    this.light("day");
    this.#fit();
  }

  /** Shows a storey of a world; where the camera stands stays, if it showed one already. */
  show(world: World, level: number) {
    const first = !this.#bodies;
    this.#clear();
    const bodies = bodiesOf(world, level);
    this.#bodies = bodies;
    this.#scene.add(bodies.root);
    const solid = bodies.solid;
    if (solid) {
      const collider = new MeshBVH(solid);
      solid.boundsTree = collider;
      this.#collider = collider;
    }
    this.#openings = [];
    this.#adopt(bodies.leaves.map((leaf) => ({ id: leaf.doorId, set: leaf.set })));
    this.#lamps = bodies.floors.slice(0, LIGHTS).map(({ at, height }) => {
      const lamp = new PointLight("#ffd9a0", 0, 9, 1.6);
      lamp.position.set(at.x, at.y, height - 0.2);
      bodies.root.add(lamp);
      return lamp;
    });
    this.light(this.#night ? "night" : "day");
    this.#overhead(this.#walking);
    if (first) this.whole();
    this.#ask();
    const isOver = () => this.#over || this.#bodies !== bodies;
    const furnished = (placementIds: string[]) => {
      for (const id of placementIds) {
        const parts = movingParts(bodies.objects.get(id) as Object3D);
        this.#adopt(parts.map((part) => ({ id: partId(id, part.name), set: part.set })));
      }
      this.onmodels();
      this.#ask();
    };
    void furnish(bodies.objects, world.placements?.placements ?? [], furnished, isOver);
  }

  /** Takes openings in, as far open as they were. */
  #adopt(openings: Opening[]) {
    for (const opening of openings) opening.set(this.#open.get(opening.id)?.now ?? 0);
    this.#openings.push(...openings);
  }

  /** Returns the names of the parts of a thing that move, once its model is there. */
  partsOf(placementId: string): string[] {
    const start = partId(placementId, "");
    return this.#openings.filter((o) => o.id.startsWith(start)).map((o) => o.id.slice(start.length));
  }

  /** Looks at a thing from its front, from inside of its room. */
  lookAt(world: World, placementId: string) {
    const object = objectOf(world, placementId);
    const pose = object?.pose;
    if (!object || !pose) return;
    const net = corners(roomOf(world, object.roomId)?.netPolygon);
    const [dx, dy] = [Math.cos(pose.yawRad), Math.sin(pose.yawRad)];
    const at = { x: pose.xM, y: pose.yM };
    const { widthM = 1, depthM = 1, heightM = 1 } = object.sizeM ?? {};
    const wished = LOOK.near + LOOK.lengths * Math.max(widthM, depthM, heightM);
    const free = inside(net, at) ? (reach(net, at, dx, dy) ?? wished) - 0.1 : wished;
    const far = Math.max(LOOK.near, Math.min(wished, free));
    const middle = pose.zM + heightM / 2;
    this.#walking = false;
    this.#controls.enabled = true;
    this.#overhead(true);
    this.#controls.target.set(at.x, at.y, middle);
    this.#camera.position.set(at.x + dx * far, at.y + dy * far, middle + LOOK.above);
    this.#controls.update();
    this.#ask();
  }

  #night = false;

  light(time: "day" | "night") {
    this.#night = time === "night";
    this.#scene.background = new Color(SKY[time]);
    this.#sun.intensity = this.#night ? 0 : 1.4;
    this.#hemisphere.intensity = this.#night ? 0.08 : 2.2;
    this.#ambient.intensity = this.#night ? 0.5 : 0;
    for (const lamp of this.#lamps) lamp.intensity = this.#night ? 14 : 0;
    this.#ask();
  }

  /** Looks at the whole storey from above. */
  whole() {
    this.#walking = false;
    this.#controls.enabled = true;
    const box = this.#bodies ? new Box3().setFromObject(this.#bodies.root) : new Box3();
    if (box.isEmpty()) return;
    const middle = box.getCenter(new Vector3());
    this.#controls.target.copy(middle);
    // as near as has every corner of the building in the picture
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
      (i) => new Vector3(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z),
    );
    const isWhole = (far: number) => {
      this.#camera.position.copy(ABOVE).multiplyScalar(far).add(middle);
      this.#controls.update();
      this.#camera.updateMatrixWorld();
      return corners.every((corner) => {
        const { x, y } = corner.clone().project(this.#camera);
        return Math.abs(x) < FILLED && Math.abs(y) < FILLED;
      });
    };
    let far = box.getSize(new Vector3()).length() / 2;
    while (!isWhole(far) && far < FARTHEST) far *= 1.04;
    this.#overhead(false);
    this.#ask();
  }

  /** Shows or hides what hangs from ceilings, which is in the way from above. */
  #overhead(visible: boolean) {
    for (const body of this.#bodies?.objects.values() ?? []) body.visible = visible || !body.userData.overhead;
  }

  /** Stands on the floor at a point, looking along a heading, the eyes so high. */
  walk(at: { x: number; y: number }, heading: number, eyes = EYES) {
    this.#walking = true;
    this.#overhead(true);
    this.#controls.enabled = false;
    this.#eyes = eyes;
    this.#heading = heading;
    this.#pitch = 0;
    this.#camera.position.set(at.x, at.y, eyes);
    this.#look();
  }

  /** Turns who walks, by shares of the picture. */
  turn(dx: number, dy: number) {
    if (!this.#walking) return;
    this.#heading -= dx * 2.5;
    this.#pitch = Math.max(-1.2, Math.min(1.2, this.#pitch - dy * 2));
    this.#look();
  }

  /** Hears that a key is held or let go; returns true for a key that walks. */
  key(key: string, down: boolean): boolean {
    const name = key.length === 1 ? key.toLowerCase() : key;
    if (!this.#walking || !(name in WAYS)) return false;
    if (down) this.#keys.add(name);
    else this.#keys.delete(name);
    this.#ask();
    return true;
  }

  /** Opens a door, or shuts it when it is open. */
  toggle(doorId: string) {
    this.#wish(doorId, (this.#open.get(doorId)?.wished ?? 0) > 0.5 ? 0 : 1);
  }

  /** Opens a part of a thing, or shuts it when it is open. */
  togglePart(placementId: string, part: string) {
    this.toggle(partId(placementId, part));
  }

  /** Opens all doors, or shuts them. */
  all(open: boolean) {
    for (const leaf of this.#bodies?.leaves ?? []) this.#wish(leaf.doorId, open ? 1 : 0);
  }

  #wish(id: string, wished: number) {
    const state = this.#open.get(id);
    if ((state?.wished ?? 0) === wished) return;
    this.#open.set(id, { now: state?.now ?? 0, wished });
    this.onopen([...this.#open].filter(([, s]) => s.wished > 0.5).map(([open]) => open));
    this.#ask();
  }

  /** Returns what lies under a point of the element, in shares of its size. */
  pick(x: number, y: number): Picked | undefined {
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(x * 2 - 1, 1 - y * 2), this.#camera);
    const hits: Intersection[] = this.#bodies ? ray.intersectObject(this.#bodies.root, true) : [];
    let part: string | undefined;
    for (let object: Object3D | null = hits[0]?.object ?? null; object; object = object.parent) {
      const { objectId, doorId, roomId } = object.userData as Picked;
      if (objectId || doorId || roomId) return { objectId, doorId, roomId, part };
      part ??= jointOf(object)?.name;
    }
    return undefined;
  }

  dispose() {
    this.#over = true;
    this.#resize.disconnect();
    this.#clear();
    this.#controls.dispose();
    this.#renderer.dispose();
    this.#renderer.domElement.remove();
  }

  #clear() {
    this.#bodies?.root.traverse((body) => {
      if (body instanceof Mesh && body.geometry instanceof BufferGeometry) body.geometry.dispose();
    });
    this.#bodies?.root.removeFromParent();
    this.#collider = undefined;
  }

  #look() {
    const { x, y, z } = this.#camera.position;
    const level = Math.cos(this.#pitch);
    this.#camera.lookAt(x + Math.cos(this.#heading) * level, y + Math.sin(this.#heading) * level, z + Math.sin(this.#pitch));
    this.#ask();
  }

  #fit() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.#renderer.setSize(width, height);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#ask();
  }

  #ask() {
    if (this.#asked || this.#over) return;
    this.#asked = true;
    requestAnimationFrame((now) => this.#draw(now));
  }

  #draw(now: number) {
    this.#asked = false;
    if (this.#over) return;
    const passed = Math.min(0.1, (now - this.#last) / 1000);
    this.#last = now;
    const goesOn = this.#step(passed) || this.#swing(passed);
    this.#renderer.render(this.#scene, this.#camera);
    if (goesOn) this.#ask();
  }

  /** Moves who walks, along walls where they are in the way; returns true while a key is held. */
  #step(passed: number): boolean {
    if (!this.#walking || this.#keys.size === 0) return false;
    let [ahead, left] = [0, 0];
    for (const key of this.#keys) {
      ahead += WAYS[key][0];
      left += WAYS[key][1];
    }
    const [c, s] = [Math.cos(this.#heading), Math.sin(this.#heading)];
    const by = WALKER.speed * passed;
    const go = new Vector3((ahead * c - left * s) * by, (ahead * s + left * c) * by, 0);
    const from = this.#camera.position;
    for (const way of [go, new Vector3(go.x, 0, 0), new Vector3(0, go.y, 0)]) {
      const next = from.clone().add(way);
      if (!this.#isFree(from, next)) continue;
      from.set(next.x, next.y, this.#eyes);
      break;
    }
    for (const leaf of this.#bodies?.leaves ?? []) {
      if (Math.hypot(leaf.body.position.x - from.x, leaf.body.position.y - from.y) < DOOR.near) this.#wish(leaf.doorId, 1);
    }
    this.#look();
    return true;
  }

  #isFree(from: Vector3, to: Vector3): boolean {
    const far = (p: Vector3) =>
      this.#collider?.closestPointToPoint(new Vector3(p.x, p.y, WALKER.knees))?.distance ?? Infinity;
    const next = far(to);
    return next > WALKER.radius || next > far(from);
  }

  /** Moves what opens towards where it is to be; returns true while some moves. */
  #swing(passed: number): boolean {
    let moves = false;
    for (const state of this.#open.values()) {
      const left = state.wished - state.now;
      const by = passed / DOOR.time;
      moves ||= left !== 0;
      state.now = Math.abs(left) <= by ? state.wished : state.now + Math.sign(left) * by;
    }
    if (moves) for (const opening of this.#openings) opening.set(this.#open.get(opening.id)?.now ?? 0);
    return moves;
  }
}
