// The page of an animation: the robot, what its axes do, and the controls of time and camera.
// `run` is what page.py has written; THREE is three.js.
"use strict";

const run = JSON.parse(document.getElementById("run").textContent);
const element = (id) => document.getElementById(id);
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function bytes(base64) {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)).buffer;
}
const floats = (base64) => (base64 === null ? null : new Float32Array(bytes(base64)));

const poses = floats(run.poses); // of each frame: of each arm: x y z, quaternion x y z w
const referencePoses = floats(run.reference_poses);
const torque = floats(run.motor_torque);
const error = floats(run.control_error);
const POSE = 7;

// --- time ----------------------------------------------------------------------------------------

let time = 0;
let playing = false;

// The frame before an instant, the frame after it, and how far it is between them.
function between(t) {
  const place = run.duration ? (t / run.duration) * (run.frames - 1) : 0;
  const before = Math.min(Math.floor(place), run.frames - 1);
  return [before, Math.min(before + 1, run.frames - 1), place - before];
}

function value(signal, axis, t) {
  const [before, after, share] = between(t);
  const a = signal[before * run.axes + axis];
  return a + share * (signal[after * run.axes + axis] - a);
}

// What holds at an instant, of a list of [begin, branch] in the order of time.
function at(stays, t) {
  return stays.findLast(([begin]) => begin <= t)[1];
}

// --- the scene -----------------------------------------------------------------------------------

const canvas = element("stage");
let renderer;
try {
  renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
} catch (reason) {
  element("facts").textContent = "This page needs WebGL, which the browser does not offer.";
  throw reason;
}
THREE.ColorManagement.legacyMode = false; // colours of CSS are sRGB
renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
renderer.outputEncoding = THREE.sRGBEncoding;
renderer.shadowMap.enabled = true;
renderer.shadowMap.type = THREE.PCFSoftShadowMap;

const scene = new THREE.Scene();
scene.fog = new THREE.Fog(style("--horizon"));
addLights();
addFloor();

// The sun casts shadows; the sky, the floor and a lamp on the other side light what it leaves dark.
function addLights() {
  scene.add(new THREE.HemisphereLight(0xffffff, 0x9aa5b1, 0.66));
  const lamp = new THREE.DirectionalLight(0xdfeaff, 0.35);
  lamp.position.set(-2.0, 3.0, 1.5);
  scene.add(lamp);
  const sun = new THREE.DirectionalLight(0xfffaf0, 0.72);
  sun.position.set(3.0, -0.4, 4.5);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  sun.shadow.radius = 3;
  sun.shadow.normalBias = 0.02;
  Object.assign(sun.shadow.camera, { left: -2.2, right: 2.2, top: 2.2, bottom: -2.2, near: 0.5, far: 9 });
  scene.add(sun);
}

function addFloor() {
  const shadow = new THREE.Mesh(new THREE.PlaneGeometry(30, 30), new THREE.ShadowMaterial({ opacity: 0.22 }));
  shadow.receiveShadow = true;
  shadow.position.z = run.floor;
  const grid = (size, step, colour) => {
    const lines = new THREE.GridHelper(size, size / step, colour, colour);
    lines.rotation.x = Math.PI / 2;
    lines.position.z = run.floor + 0.001;
    scene.add(lines);
  };
  scene.add(shadow);
  grid(20, 0.25, 0xd3d9df);
  grid(20, 1, 0xb4bcc4);
}

let robot = null;
let ghost = null;

// Moves the arms of a robot to an instant: along a line, and about an axis, from frame to frame.
function place(model, from, t) {
  const [before, after, share] = between(t);
  const turned = new THREE.Quaternion();
  run.arms.forEach((name, k) => {
    const arm = model.getObjectByName(name);
    const a = (before * run.arms.length + k) * POSE;
    const b = (after * run.arms.length + k) * POSE;
    arm.position.fromArray(from, a).lerp(new THREE.Vector3().fromArray(from, b), share);
    arm.quaternion.fromArray(from, a + 3).slerp(turned.fromArray(from, b + 3), share);
  });
}

function meshes(model) {
  const found = [];
  model.traverse((node) => node.isMesh && found.push(node));
  return found;
}

function build(gltf) {
  robot = gltf.scene;
  for (const mesh of meshes(robot)) {
    mesh.castShadow = mesh.receiveShadow = true;
    if (mesh.material.name === "branch") mesh.material = mesh.material.clone(); // each joint its own
  }
  if (referencePoses) {
    ghost = robot.clone();
    // Where both are at one place the robot is seen.
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 8 };
    const sheer = new THREE.MeshLambertMaterial({
      color: run.ghost.colour,
      transparent: true,
      opacity: 0.45,
      depthWrite: false,
      ...behind,
    });
    // Depth first, then colour where nothing of the ghost is nearer: it looks like one body.
    const depth = new THREE.MeshBasicMaterial({ colorWrite: false, ...behind });
    for (const mesh of meshes(ghost)) {
      const before = mesh.clone();
      before.material = depth;
      before.renderOrder = 1;
      mesh.parent.add(before);
      mesh.material = sheer;
      mesh.renderOrder = 2;
      mesh.castShadow = mesh.receiveShadow = before.castShadow = before.receiveShadow = false;
    }
    ghost.getObjectByName("base").visible = false;
    scene.add(ghost);
  }
  scene.add(robot);
  resize();
  balls = everywhere();
  look("oblique");
  seek(Number(location.hash.slice(1)) || 0); // run.html#0.7 begins at 0.7 s
  document.body.dataset.ready = "true";
}

// --- the camera ----------------------------------------------------------------------------------

const camera = new THREE.PerspectiveCamera(32, 1, 0.05, 40);
camera.up.set(0, 0, 1);
const VIEWS = { oblique: [0.6, 0.28], side: [0, 0.06], front: [-Math.PI / 2, 0.06], top: [-Math.PI / 2, 1.5] };
const target = new THREE.Vector3();
const slope = Math.tan(THREE.MathUtils.degToRad(camera.fov / 2));
let azimuth, elevation, distance;
let balls = [];

// Balls around all parts, at instants of the whole run.
function everywhere() {
  const balls = [];
  for (let k = 0; k <= 12; k++) {
    place(robot, poses, (k / 12) * run.duration);
    robot.updateMatrixWorld();
    for (const mesh of meshes(robot)) balls.push(mesh.geometry.boundingSphere.clone().applyMatrix4(mesh.matrixWorld));
  }
  return balls;
}

// Looks from a side at all of that, as near as it fits into the picture.
function look(view) {
  [azimuth, elevation] = VIEWS[view];
  new THREE.Box3().setFromPoints(balls.map((ball) => ball.center)).getCenter(target);
  distance = 1;
  aim();
  const [right, up, back] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
  camera.matrix.extractBasis(right, up, back);
  const needed = balls.map(({ center, radius }) => {
    const apart = center.clone().sub(target);
    const high = (Math.abs(apart.dot(up)) + radius) / slope;
    const wide = (Math.abs(apart.dot(right)) + radius) / (slope * camera.aspect);
    return Math.max(high, wide) + apart.dot(back);
  });
  distance = needed.reduce((a, b) => Math.max(a, b));
  draw();
}

function aim() {
  elevation = THREE.MathUtils.clamp(elevation, -0.2, 1.55);
  distance = THREE.MathUtils.clamp(distance, 0.3, 12);
  const across = Math.cos(elevation);
  camera.position
    .set(across * Math.cos(azimuth), across * Math.sin(azimuth), Math.sin(elevation))
    .multiplyScalar(distance)
    .add(target);
  camera.lookAt(target);
  camera.updateMatrix();
  scene.fog.near = distance;
  scene.fog.far = distance + 6;
}

const fingers = new Map(); // pointers that are down, by their number

function drag(event) {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
  if (fingers.size === 2) {
    const [other] = [...fingers.entries()].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
    const apart = (at) => Math.hypot(at.clientX - other.clientX, at.clientY - other.clientY);
    distance *= apart(before) / Math.max(apart(event), 1);
    shift(dx / 2, dy / 2);
  } else if (event.buttons & 2 || event.shiftKey) {
    shift(dx, dy);
  } else {
    azimuth -= 0.006 * dx;
    elevation += 0.006 * dy;
  }
  fingers.set(event.pointerId, event);
  draw();
}

function shift(dx, dy) {
  const metres = (2 * distance * slope) / camera.view.fullHeight; // of a pixel
  const [right, up] = [new THREE.Vector3(), new THREE.Vector3()];
  camera.matrix.extractBasis(right, up, new THREE.Vector3());
  target.addScaledVector(right, -dx * metres).addScaledVector(up, dy * metres);
}

canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, event);
});
canvas.addEventListener("pointermove", drag);
for (const name of ["pointerup", "pointercancel"]) {
  canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
}
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  distance *= Math.exp(0.001 * event.deltaY);
  draw();
}, { passive: false });
for (const button of document.querySelectorAll("[data-view]")) {
  button.addEventListener("click", () => look(button.dataset.view));
}

// --- the axes ------------------------------------------------------------------------------------

// What a branch of each other element is called, and whether it is worth a look.
const MARKS = {
  dead_zone: (b) => ["dead zone", b === 0],
  torque_limit: (b) => ["limit", b !== 0, "alarm"],
  voltage_limit: (b) => ["voltage", b !== 0, "alarm"],
  backlash: (b) => [b === 0 ? "gap" : b > 0 ? "contact +" : "contact \u2212", b === 0],
};
const number = (x, digits) => (Math.abs(x) < 0.5 * 10 ** -digits ? 0 : x).toFixed(digits).replace("-", "\u2212");

function card(axis) {
  const friction = run.branches.friction?.[axis];
  const made = document.createElement("section");
  made.className = "axis";
  made.innerHTML =
    `<h2>axis ${axis + 1}</h2><span class="friction"></span><span class="torque"></span>` +
    `<div class="chart"><svg viewBox="0 -0.05 1 1.1" preserveAspectRatio="none">${chart(axis, friction)}</svg><i></i></div>` +
    `<div class="below"></div>`;
  element("axes").append(made);
  const part = (name) => made.querySelector(name);
  const below = (name) => {
    const words = document.createElement("span");
    words.className = name;
    part(".below").append(words);
    return words;
  };
  const marks = Object.keys(MARKS).filter((name) => run.branches[name]?.[axis]).map((name) => [name, below("mark")]);
  for (const [name, mark] of marks) mark.title = name.replace("_", " ");
  const errorShown = below("error");

  return function show(t) {
    if (friction) {
      const branch = 1 + at(friction, t);
      part(".friction").textContent = run.friction.words[branch];
      part(".friction").style.color = run.friction.colours[branch];
    }
    part(".torque").textContent = `${number(value(torque, axis, t), 2)} N m`;
    for (const [name, mark] of marks) {
      const [words, on, kind = ""] = MARKS[name](at(run.branches[name][axis], t));
      mark.textContent = words;
      mark.className = `mark ${kind} ${on ? "on" : ""}`;
    }
    errorShown.textContent = error ? `error ${number(1e3 * value(error, axis, t), 2)} mrad` : "no reference";
    part("i").style.left = `${100 * share(t)}%`;
  };
}

const share = (t) => (run.duration ? t / run.duration : 0);

// The motor torque over time, both from 0 to 1; grey behind it while the axis sticks.
function chart(axis, friction) {
  const sticks = (friction ?? []).map(([begin, stays], k) => {
    const wide = share((friction[k + 1]?.[0] ?? run.duration) - begin);
    return stays === 0 ? `<rect x="${share(begin)}" y="-1" width="${wide}" height="3"/>` : "";
  });
  const values = Array.from({ length: run.frames }, (_, k) => torque[k * run.axes + axis]);
  const low = values.reduce((a, b) => Math.min(a, b), -0.005); // N m: less than that is a line
  const high = values.reduce((a, b) => Math.max(a, b), 0.005);
  const y = (u) => ((high - u) / (high - low)).toFixed(4);
  const points = values.map((u, k) => `${(k / (run.frames - 1)).toFixed(5)},${y(u)}`);
  return (
    `${sticks.join("")}<line x1="0" x2="1" y1="${y(0)}" y2="${y(0)}"/>` + `<polyline points="${points.join(" ")}"/>`
  );
}

const cards = Array.from({ length: run.axes }, (_, axis) => card(axis));

// --- events --------------------------------------------------------------------------------------

const instants = [...new Set(run.events.map(([when]) => when))];
element("ticks").innerHTML = instants.map((when) => `<path d="M${share(when)} 0V1"/>`).join("");

function toEvent(direction) {
  const there = direction > 0 ? instants.find((when) => when > time) : instants.findLast((when) => when < time);
  pause();
  seek(there ?? (direction > 0 ? run.duration : 0));
}

// --- controls ------------------------------------------------------------------------------------

const slider = element("slider");
const speed = element("speed");

function seek(t) {
  time = THREE.MathUtils.clamp(t, 0, run.duration);
  slider.value = time;
  element("time").textContent = `${time.toFixed(3)} s`;
  const last = run.events.findLast(([when]) => when <= time);
  element("event").textContent = last ? `${last[0].toFixed(4)} s: ${last[1]}` : "";
  for (const show of cards) show(time);
  if (robot) {
    place(robot, poses, time);
    if (ghost) place(ghost, referencePoses, time);
    for (const mesh of meshes(robot)) colour(mesh);
    draw();
  }
}

// A joint is coloured as its friction is; the mark of an arm is the joint that moves it.
function colour(mesh) {
  const friction = run.branches.friction?.[run.arms.indexOf(mesh.parent.name)];
  if (mesh.material.name !== "branch" || !friction) return;
  mesh.material.color.set(run.friction.colours[1 + at(friction, time)]);
}

let drawing = 0;

function draw() {
  drawing ||= requestAnimationFrame(() => {
    drawing = 0;
    aim();
    renderer.render(scene, camera);
  });
}

let clock = 0; // [ms] of the picture before

function play() {
  if (time >= run.duration) seek(0);
  playing = true;
  clock = performance.now();
  symbol();
  requestAnimationFrame(advance);
}

function advance(now) {
  if (!playing) return;
  seek(time + (1e-3 * Math.max(now - clock, 0)) * Number(speed.value));
  clock = now;
  if (time >= run.duration) pause();
  else requestAnimationFrame(advance);
}

function pause() {
  playing = false;
  symbol();
}

const SYMBOLS = { pause: "M5 4h3.5v12H5zM11.5 4H15v12h-3.5z", play: "M5 3v14l12-7z" };
const symbol = () => element("play").querySelector("path").setAttribute("d", SYMBOLS[playing ? "pause" : "play"]);
const toggle = () => (playing ? pause() : play());

function resize() {
  const [width, height] = [window.innerWidth, window.innerHeight];
  renderer.setSize(width, height, false);
  // The picture is as large as what heading, axes and controls leave free.
  const top = document.querySelector("header").offsetHeight;
  const [wide, high] = [width - element("axes").offsetWidth, height - top - element("transport").offsetHeight];
  camera.aspect = wide / high;
  camera.setViewOffset(wide, high, 0, -top, width, height);
  draw();
}

element("play").addEventListener("click", toggle);
element("back").addEventListener("click", () => toEvent(-1));
element("forth").addEventListener("click", () => toEvent(1));
slider.addEventListener("input", () => {
  pause();
  seek(Number(slider.value));
});
window.addEventListener("resize", resize);
window.addEventListener("keydown", (event) => {
  const frame = run.duration / (run.frames - 1);
  const keys = {
    " ": toggle,
    ArrowLeft: () => (pause(), seek(time - frame)),
    ArrowRight: () => (pause(), seek(time + frame)),
    PageUp: () => toEvent(-1),
    PageDown: () => toEvent(1),
    Home: () => seek(0),
    End: () => seek(run.duration),
  };
  if (!keys[event.key] || event.target === speed) return;
  event.preventDefault();
  keys[event.key]();
});

// --- begin ---------------------------------------------------------------------------------------

slider.max = run.duration;
speed.value = run.duration < 4 ? "0.25" : "1";
element("facts").textContent = run.facts;
element("ghost").hidden = !referencePoses;
element("ghost").querySelector("span").textContent = run.ghost.words;
element("ghost").style.setProperty("accent-color", run.ghost.colour);
element("ghost").querySelector("input").addEventListener("change", (event) => {
  ghost.visible = event.target.checked;
  draw();
});
symbol();
new THREE.GLTFLoader().parse(bytes(run.model), "", build, (reason) => { throw reason; });

// For those who drive the page by script.
window.animation = {
  seek,
  look,
  get time() { return time; },
  get playing() { return playing; },
  // The frame of an arm in the world, 16 numbers, column by column.
  pose(name, of = robot) {
    of.updateMatrixWorld();
    return of.getObjectByName(name).matrixWorld.toArray();
  },
  referencePose: (name) => window.animation.pose(name, ghost),
};
