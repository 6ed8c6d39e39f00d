// The run: what is shown, and what is done to it.
let status = null, path = [], goal = null, running = true, speed = 1, owed = 0, before = 0, laws = 0, frames = 0, tool = "move";
const sketch = { line: [], ice: null, push: null };
const START = { base: 1, gyro: false, floor: 1, seed: 1 };

let hintTimer;
function hint(text, bad = false) {
  const h = $("hint"); h.textContent = text; h.className = "shown" + (bad ? " bad" : "");
  clearTimeout(hintTimer); hintTimer = setTimeout(() => (h.className = ""), bad ? 6000 + 40 * Math.min(text.length, 500) : 2500);
}
// What nobody catches is at least said.
addEventListener("error", (e) => hint(`Something went wrong: ${e.message}`, true));
addEventListener("unhandledrejection", (e) => hint(`Something went wrong: ${e.reason && e.reason.message || e.reason}`, true));
function apply(bytes) {
  touched = true;
  send(bytes);
  if (wasm.apply()) return true;
  hint(said(), true);
  return false;
}
const readStatus = () => { wasm.status(); status = JSON.parse(said()); };
function readPath() { const n = wasm.path(), all = numbers(n); path = []; for (let i = 0; i < n; i += 2) path.push([all[i], all[i + 1]]); }
const OWN = 255;
const choice = () => ({ base: $("base").selectedIndex < about.bases.length ? Math.max(0, $("base").selectedIndex) : OWN, gyro: $("gyro").checked, floor: +$("floor").value, seed: Math.max(0, Math.min(65535, +$("seed").value || 0)) });

// Before the first tick it stands where it begins.
function afresh() {
  readStatus(); history.clear();
  const { x, y, theta: a, period, ticks, state } = status;
  history.push({ t: ticks * period, others: [], main: { x, y, a, bx: x, by: y, ba: a, v: 0, w: 0, vc: NaN, wc: NaN, tr: 0, tl: 0, state: about.states.indexOf(state), faults: 0 } });
}
function afterBegin() {
  path = []; goal = null; owed = 0;
  afresh();
  if (laws) apply(INPUT.laws(laws));
  refresh();
}
function begin(s = choice()) {
  if (!apply(INPUT.begin(s))) return;
  afterBegin();
  setGoal([1.6, 0.8, Math.PI / 4]);
  refresh(); fit();
}
// What is put beyond the floor's end comes to lie on its edge.
function within(p) {
  const q = onFloor(p);
  if (q[0] !== p[0] || q[1] !== p[1]) hint(`The floor ends ${FLOOR} m from its middle`, true);
  return q;
}
function setGoal(p) { p = within(p); goal = [p[0], p[1], wrap(p[2])]; if (apply(INPUT.goal(goal))) path = []; }
function refresh() { readStatus(); showControls(); }

// Everything that depends on inputs, not on time.
function showControls() {
  const b = status.base;
  const own = b.index === OWN, list = $("base");
  while (list.options.length > about.bases.length) list.remove(about.bases.length);
  if (own) list.add(new Option(b.name));
  list.selectedIndex = own ? about.bases.length : b.index;
  $("floor").value = b.floor; $("seed").value = b.seed; $("gyro").checked = b.gyro;
  $("subtitle").textContent = `${b.name}: the firmware's controller on a simulated robot`;
  $("host").setAttribute("aria-pressed", !status.host); $("host").textContent = status.host ? "Kill host" : "Revive host";
  [...$("breaks").children].forEach((button, n) => button.dataset.fault && button.setAttribute("aria-pressed", ((status.injected >> n) & 1) === 1));
  $("thaw").hidden = !status.patches.length;
}

const KIND = { tracking: "go", parking: "go", parked: "good", armed: "go", stopping: "warn", braking: "bad", stopped: "warn", fault: "bad" };
const put = (id, text) => { const e = $(id); if (e.textContent !== text) e.textContent = text; };
const mm = (m) => (Number.isFinite(m) ? (1000 * m < 100 ? (1000 * m).toFixed(1) : Math.round(1000 * m).toString()) : "–");
function errors(p) { return goal && p ? [Math.hypot(goal[0] - p.x, goal[1] - p.y), Math.abs(wrap(goal[2] - p.a))] : [NaN, NaN]; }
function showState() {
  const row = history.last, m = row && row.main;
  if (!m) return;
  const state = about.states[m.state];
  put("state", state); $("state").dataset.kind = KIND[state] || "";
  const faults = board.on ? about.kinds.filter((_, n) => (m.faults >>> n) & 1) : status.faults;
  const cause = board.on ? board.cause : status.cause;
  put("cause", cause ? `cause: ${cause}` : ""); put("clock", row.t.toFixed(2) + " s");
  const f = faults.join("|");
  if ($("faults").dataset.now !== f) { $("faults").dataset.now = f; $("faults").replaceChildren(...faults.map((name) => Object.assign(document.createElement("span"), { textContent: name }))); }
  const [d, a] = board.on ? [Math.hypot(m.ex, m.ey), Math.abs(m.ea)] : errors(m);
  put("f-distance", mm(d)); put("f-heading", mm(a)); put("f-speed", m.v.toFixed(2).replace("-", "−"));
  put("f-estimate", board.on ? "–" : mm(Math.hypot(m.x - m.bx, m.y - m.by)));
  put("hash", board.on ? "–" : status.hash); put("ticks", board.on ? String(board.reports) : String(status.ticks));
  if (board.on) return;
  const robots = [m, ...row.others];
  LAW.forEach(([name], k) => {
    const tr = $("law-" + name), p = robots[k], [pd, pa] = errors(p), answer = status.laws.find((l) => l.law === name);
    const cells = p ? [mm(pd) + " mm", mm(pa) + " mrad", answer && answer.refused ? "no answer" : about.states[p.state]] : ["", "", ""];
    cells.forEach((text, i) => { if (tr.cells[i + 1].textContent !== text) tr.cells[i + 1].textContent = text; });
  });
}

let rateAt = 0, rateTicks = 0;
// Drawn is what has changed: a board that says nothing, and a pause, cost nothing.
let touched = true, drawnRows = 0;
for (const kind of ["pointerdown", "pointermove", "pointerup", "wheel", "keydown", "click", "change", "resize", "hashchange"]) addEventListener(kind, () => (touched = true), { capture: true, passive: true });
function frame(now) {
  requestAnimationFrame(frame);
  const passed = Math.min(0.1, (now - before) / 1000); before = now;
  if (board.on) { takeReports(); }
  else {
    if (running) {
      drive();
      owed += (passed * speed) / status.period;
      const until = performance.now() + (speed > 100 ? 24 : 14);
      while (owed >= 1 && performance.now() < until) {
        const ticks = Math.min(Math.floor(owed), 50);
        if (!wasm.advance(ticks)) { hint(said(), true); running = false; showPlay(); break; }
        owed -= ticks;
      }
      if (owed > 100) owed = 0;
    }
    takeRows(); readStatus();
    if (now - rateAt > 1000) {
      const rate = ((status.ticks - rateTicks) * status.period * 1000) / (now - rateAt);
      put("rate", running && rate > 0 ? (rate >= 10 ? Math.round(rate) : rate.toFixed(1)) + "× real time" : "");
      rateAt = now; rateTicks = status.ticks;
    }
  }
  if (!touched && history.n === drawnRows) return;
  touched = false; drawnRows = history.n;
  drawMap(); drawPlots(); showState();
  board.drawn = Date.now();
  if (!frames++) { document.documentElement.dataset.first = Math.round(performance.now()); }
}
function showPlay() {
  $("play").querySelector("span").textContent = running ? "Pause" : "Run";
  $("play").querySelector("path").setAttribute("d", running ? "M3 2h4v12H3zM9 2h4v12H9z" : "M4 2l10 6-10 6z");
}
const step = () => { running = false; showPlay(); wasm.advance(1); };

// Sharing: all inputs so far, packed, in the fragment: how, a checksum, which older links do not have, and they.
const sumOf = (text) => { let sum = 0x811c9dc5; for (const c of text) sum = Math.imul(sum ^ c.charCodeAt(0), 0x01000193); return (sum >>> 0).toString(36); };
async function through(stream, bytes) { return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer()); }
async function link() {
  if (!wasm.share()) throw new Error(said());
  let bytes = view().slice(), kind = "r";
  if (typeof CompressionStream === "function") { bytes = await through(new CompressionStream("deflate-raw"), bytes); kind = "z"; }
  const text = toBase64(bytes).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return `${location.href.split("#")[0]}#${kind}${sumOf(kind + text)}=${text}`;
}
async function share() {
  running = false; showPlay();
  let url;
  try { url = await link(); } catch (error) { return hint(`No link: ${error.message}`, true); }
  window.history.replaceState(null, "", url);
  try { await navigator.clipboard.writeText(url); hint("Link copied: it plays this run again, bit for bit, up to this tick"); }
  catch { hint("The link is in the address bar: it plays this run again, bit for bit, up to this tick"); }
}
async function packedIn(fragment) {
  const [, kind, sum, text] = /^#([rz])(\w*)=([\w-]+)$/.exec(fragment);
  if (sum && sum !== sumOf(kind + text)) throw new Error("another checksum");
  const bytes = fromBase64(text.replaceAll("-", "+").replaceAll("_", "/"));
  return kind === "z" ? through(new DecompressionStream("deflate-raw"), bytes) : bytes;
}
async function open(fragment) {
  if (!fragment) return false;
  try {
    // Why it cannot be unpacked, each browser says otherwise.
    const bytes = await packedIn(fragment).catch(() => { throw new Error("it is damaged, cut off perhaps"); });
    send(bytes);
    if (!wasm.replay()) throw new Error(said());
  } catch (error) { hint(`This link cannot be opened: ${error.message}`, true); return false; }
  history.clear(); running = false; showPlay(); refresh(); takeRows(); readPath();
  laws = status.laws.reduce((mask, l) => mask | (l.law === "neural" ? 1 : l.law === "plain" ? 2 : 0), 0);
  LAW.slice(1).forEach(([name], k) => ($("law-" + name).querySelector("input").checked = (laws >> k) & 1));
  goal = status.goal; fit();
  hint("A shared run, at the tick at which it was shared");
  return true;
}

// Pointers: one moves something or the view, two zoom.
const pointers = new Map();
let grip = null;
const local = (e) => { const r = map.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
function gripAt(px, py, shift) {
  const near = (p, r) => { const [x, y] = toScreen(p[0], p[1]); return Math.hypot(x - px, y - py) < r; };
  const b = status.base, body = Math.max(22, 0.6 * b.track * camera.scale), m = history.last && history.last.main, robot = m && [m.x, m.y, m.a];
  if (tool !== "move" || board.on) return null;
  if (goal && near(handleOf(goal, b), 18)) return { kind: "goal-turn" };
  if (robot && near(handleOf(robot, b, -1), 18)) return { kind: "robot-turn", from: robot };
  if (goal && !shift && near(goal, body) && !(robot && near(robot, 0.5 * body) && !near(goal, 0.5 * body))) return { kind: "goal", off: diff(goal, px, py) };
  if (robot && near(robot, body)) return { kind: "robot", from: robot, off: diff(robot, px, py) };
  return null;
}
const diff = (p, px, py) => { const [x, y] = toFloor(px, py); return [p[0] - x, p[1] - y]; };
const force = (a, b) => Math.min(400, Math.hypot(b[0] - a[0], b[1] - a[1]) * 12 * status.base.mass);
map.addEventListener("pointerdown", (e) => {
  map.setPointerCapture(e.pointerId);
  const [px, py] = local(e), floor = toFloor(px, py);
  pointers.set(e.pointerId, [px, py]);
  if (pointers.size === 2) { const [a, b] = [...pointers.values()]; grip = { kind: "pinch", span: Math.hypot(a[0] - b[0], a[1] - b[1]), middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] }; sketch.line = []; sketch.ice = sketch.push = null; return; }
  const m = history.last && history.last.main;
  if (!board.on && tool === "line") { grip = { kind: "line" }; sketch.line = [within(floor)]; if (m && Math.hypot(floor[0] - m.x, floor[1] - m.y) < 1.2 * status.base.track) sketch.line = [[m.x, m.y]]; }
  else if (!board.on && tool === "ice") grip = { kind: "ice", from: within(floor) };
  else if (!board.on && tool === "push" && m) { grip = { kind: "push", from: [m.x, m.y] }; sketch.push = [[m.x, m.y], floor]; }
  else grip = gripAt(px, py, e.shiftKey) || { kind: "view", at: [px, py], begun: [px, py], tap: !board.on && tool === "move" };
});
map.addEventListener("pointermove", (e) => {
  const [px, py] = local(e), [x, y] = toFloor(px, py);
  if (!pointers.has(e.pointerId)) { if (e.pointerType === "mouse" && status) { const g = gripAt(px, py, e.shiftKey); map.style.cursor = tool !== "move" ? "crosshair" : g ? "move" : "grab"; } return; }
  pointers.set(e.pointerId, [px, py]);
  if (!grip) return;
  if (grip.kind === "pinch") {
    if (pointers.size < 2) return;
    const [a, b] = [...pointers.values()], span = Math.hypot(a[0] - b[0], a[1] - b[1]), middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    camera.x -= (middle[0] - grip.middle[0]) / camera.scale; camera.y += (middle[1] - grip.middle[1]) / camera.scale;
    zoom(span / grip.span, ...middle); grip.span = span; grip.middle = middle;
  } else if (grip.kind === "view") {
    if (Math.hypot(px - grip.begun[0], py - grip.begun[1]) > 5) grip.tap = false;
    if (grip.tap) return;
    camera.x -= (px - grip.at[0]) / camera.scale; camera.y += (py - grip.at[1]) / camera.scale; grip.at = [px, py];
  } else if (grip.kind === "goal") setGoal([x + grip.off[0], y + grip.off[1], goal[2]]);
  else if (grip.kind === "goal-turn") setGoal([goal[0], goal[1], Math.atan2(y - goal[1], x - goal[0])]);
  else if (grip.kind === "robot") carry([x + grip.off[0], y + grip.off[1], grip.from[2]], !e.altKey);
  else if (grip.kind === "robot-turn") carry([grip.from[0], grip.from[1], Math.atan2(grip.from[1] - y, grip.from[0] - x)], !e.altKey);
  else if (grip.kind === "line") { const last = sketch.line[sketch.line.length - 1], p = within([x, y]); if (Math.hypot(p[0] - last[0], p[1] - last[1]) * camera.scale > 4) sketch.line.push(p); }
  else if (grip.kind === "ice") { const [a, b] = within([x, y]), [c, d] = grip.from; sketch.ice = [Math.min(a, c), Math.max(a, c), Math.min(b, d), Math.max(b, d)]; }
  else if (grip.kind === "push") sketch.push = [grip.from, [x, y]];
});
function carry(p, announced) {
  p = within(p);
  if (!apply(INPUT.place(p, announced))) return;
  // Seen at once, also in a pause.
  const last = history.last;
  if (last) Object.assign(last.main, { x: p[0], y: p[1], a: p[2] }, announced ? { bx: p[0], by: p[1], ba: p[2] } : {});
}
function let_go(e) {
  pointers.delete(e.pointerId);
  const done = grip;
  if (!done || (done.kind === "pinch" && pointers.size)) return;
  grip = null;
  const [px, py] = local(e), [x, y] = toFloor(px, py);
  if (e.type === "pointercancel") { sketch.line = []; sketch.ice = sketch.push = null; return; }
  if (done.kind === "view" && done.tap) setGoal([x, y, goal ? goal[2] : 0]);
  if (done.kind === "line") { follow(sketch.line); sketch.line = []; }
  if (done.kind === "ice") { const i = sketch.ice; sketch.ice = null; if (i && i[1] - i[0] > 0.05 && i[3] - i[2] > 0.05 && apply(INPUT.ice(...i, 0.03))) refresh(); }
  if (done.kind === "push") {
    const [a, b] = sketch.push, n = force(a, b), d = Math.atan2(b[1] - a[1], b[0] - a[0]); sketch.push = null;
    if (n > 1 && apply(INPUT.push(n * Math.cos(d), n * Math.sin(d), 0, 0.3))) hint(`Pushed with ${Math.round(n)} N for 0.3 s`);
  }
}
map.addEventListener("pointerup", let_go); map.addEventListener("pointercancel", let_go);
map.addEventListener("wheel", (e) => { e.preventDefault(); zoom(Math.exp(-e.deltaY * (e.ctrlKey ? 0.01 : 0.0015)), ...local(e)); }, { passive: false });

function follow(line) {
  // As many points as a link can hold without noticing.
  const every = Math.ceil(line.length / 400), points = line.filter((_, i) => i % every === 0 || i === line.length - 1);
  if (apply(INPUT.line(points))) { readPath(); routeGoal(); }
}
function routeGoal() { readStatus(); goal = status.goal; }

// Files: a robot, or a trajectory.
async function take(file) {
  if (file.size > 1 << 20) return hint(`${file.name} is larger than 1 MB`, true);
  const bytes = new Uint8Array(await file.arrayBuffer());
  if (board.on) return;
  if (/\.toml$/i.test(file.name)) {
    if (apply(INPUT.robot(choice(), file.name, new TextDecoder().decode(bytes)))) { afterBegin(); setGoal([1.6, 0.8, Math.PI / 4]); refresh(); fit(); hint(`${status.base.name}, from ${file.name}`); }
  } else if (apply(INPUT.file(file.name, bytes))) { readPath(); routeGoal(); afresh(); fit(); hint(`Follows ${file.name}`); }
}
addEventListener("dragover", (e) => { e.preventDefault(); $("stage").classList.add("over"); });
addEventListener("dragleave", (e) => { if (!e.relatedTarget) $("stage").classList.remove("over"); });
addEventListener("drop", (e) => { e.preventDefault(); $("stage").classList.remove("over"); for (const file of e.dataTransfer.files) take(file); });

// Driving by keys: orders while a key is held, and the goal where it then stands.
const held = new Set();
let driving = false, order = "";
function drive() {
  const has = (...k) => k.some((key) => held.has(key)), v = has("ArrowUp") - has("ArrowDown"), w = has("ArrowLeft") - has("ArrowRight");
  const b = status.base, now = `${v} ${w}`;
  if (now === order) return;
  order = now;
  if (v || w) { driving = true; goal = null; path = []; }
  else if (!driving) return;
  driving = !!(v || w);
  apply(INPUT.drive(0.5 * b.speed * v, 0.5 * b.turn_rate * w));
}
const press = { s: "stop", e: "estop", a: "arm", k: "host", r: "reset", f: "fit", "+": "in", "=": "in", "-": "out", "?": "help" };
const TOOLS = ["move", "line", "push", "ice"];
addEventListener("keydown", (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT)$/.test(e.target.tagName) || $("keys").open) return;
  const arrow = /^Arrow/.test(e.key), onButton = e.target.tagName === "BUTTON";
  if (arrow && !board.on && e.target.getAttribute("role") !== "radio") {
    e.preventDefault();
    if (!e.shiftKey) { if (!running) { running = true; showPlay(); } return held.add(e.key); }
    const from = goal || (history.last && [history.last.main.x, history.last.main.y, history.last.main.a]), d = 0.05;
    if (from) setGoal([from[0] + d * ((e.key === "ArrowRight") - (e.key === "ArrowLeft")), from[1] + d * ((e.key === "ArrowUp") - (e.key === "ArrowDown")), from[2]]);
  } else if ((e.key === "[" || e.key === "]") && goal) setGoal([goal[0], goal[1], goal[2] + (e.key === "[" ? 1 : -1) * (Math.PI / 36)]);
  else if (e.key === " " && !onButton) { e.preventDefault(); $("play").click(); }
  else if (e.key === ".") $("step").click();
  else if (e.key === "," || e.key === "/") { const s = $("speed"); s.selectedIndex = Math.max(0, Math.min(s.options.length - 1, s.selectedIndex + (e.key === "/" ? 1 : -1))); s.onchange(); }
  else if (/^[1-4]$/.test(e.key)) choose(TOOLS[e.key - 1]);
  else if (press[e.key.toLowerCase()] && $(press[e.key.toLowerCase()]).offsetParent) $(press[e.key.toLowerCase()]).click();
});
addEventListener("keyup", (e) => held.delete(e.key));
addEventListener("blur", () => held.clear());

const SAYS = { move: "Drag the robot, the goal, or their dots; tap the floor to send the robot there", line: "Draw a line: the robot follows it and parks at its end", push: "Drag away from the robot and let go", ice: "Drag a rectangle: wheels in it have a grip of 0.03" };
function choose(name) { tool = name; for (const b of $("tools").children) { b.setAttribute("aria-checked", b.dataset.tool === name); b.tabIndex = b.dataset.tool === name ? 0 : -1; } map.style.cursor = name === "move" ? "grab" : "crosshair"; hint(SAYS[name]); }
for (const b of $("tools").children) b.onclick = () => choose(b.dataset.tool);
$("tools").addEventListener("keydown", (e) => { const n = TOOLS.indexOf(tool) + (e.key === "ArrowRight") - (e.key === "ArrowLeft"); if (/Left|Right/.test(e.key)) { e.preventDefault(); choose(TOOLS[(n + 4) % 4]); $("tools").children[(n + 4) % 4].focus(); } });

function build() {
  for (const name of about.bases) $("base").add(new Option(name));
  for (const [name, title, colour] of LAW) {
    const tr = document.createElement("tr"); tr.id = "law-" + name; tr.style.setProperty("--law", `var(--${colour})`);
    tr.innerHTML = `<td><label><input type="checkbox"${name === "default" ? " checked disabled" : ""}><u></u>${title}</label></td><td></td><td></td><td></td>`;
    $("laws").tBodies[0].append(tr);
  }
  LAW.slice(1).forEach(([name], k) => ($("law-" + name).querySelector("input").onchange = (e) => { laws = e.target.checked ? laws | (1 << k) : laws & ~(1 << k); if (apply(INPUT.laws(laws))) refresh(); }));
  about.faults.forEach((name, n) => {
    const b = Object.assign(document.createElement("button"), { textContent: name, onclick: () => { if (apply(INPUT.fault(n, !((status.injected >> n) & 1)))) refresh(); } });
    b.dataset.fault = n; b.setAttribute("aria-pressed", false); $("breaks").append(b);
  });
  const thaw = Object.assign(document.createElement("button"), { id: "thaw", textContent: "Melt the ice", hidden: true, onclick: () => { if (apply(INPUT.thaw())) refresh(); } });
  $("breaks").append(thaw);
}
$("play").onclick = () => { running = !running; showPlay(); };
$("step").onclick = step;
$("speed").onchange = () => { speed = +$("speed").value; owed = 0; };
$("reset").onclick = () => { window.history.replaceState(null, "", location.href.split("#")[0]); begin(); running = true; showPlay(); };
$("share").onclick = share;
$("fit").onclick = fit; $("in").onclick = () => zoom(1.3); $("out").onclick = () => zoom(1 / 1.3);
$("help").onclick = () => $("keys").showModal();
$("stop").onclick = () => apply(INPUT.stop()); $("estop").onclick = () => apply(INPUT.estop()); $("arm").onclick = () => {
  running = true; showPlay(); readStatus();
  // The base refuses it until it stands.
  if (/^(stopping|braking)$/.test(status.state)) hint(`It is ${status.state}: arm it once it stands`, true);
  else apply(INPUT.arm());
};
$("host").onclick = () => { if (apply(INPUT.host(!status.host))) refresh(); };
for (const id of ["base", "floor", "seed", "gyro"]) $(id).onchange = () => begin();
$("file").onchange = (e) => { for (const file of e.target.files) take(file); e.target.value = ""; };
const dark = matchMedia("(prefers-color-scheme: dark)");
let theme = "auto";
function showTheme() { document.documentElement.dataset.theme = theme === "auto" ? (dark.matches ? "dark" : "light") : theme; readInk(); }
$("theme").onclick = () => { const now = document.documentElement.dataset.theme; theme = theme === "auto" ? (now === "dark" ? "light" : "dark") : "auto"; showTheme(); hint(theme === "auto" ? "Light or dark as the system" : theme); };
dark.addEventListener("change", showTheme);
addEventListener("hashchange", () => open(location.hash));
