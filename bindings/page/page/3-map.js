// The floor: metres to pixels, and everything drawn on it.
const map = $("map"), pen = map.getContext("2d");
const camera = { x: 0.8, y: 0.4, scale: 180, follow: true };
let ink = {};
const style = (el, name) => getComputedStyle(el).getPropertyValue(name).trim();
function readInk() {
  const root = document.documentElement;
  for (const name of ["paper", "panel", "ink", "soft", "line", "grid", "grid2", "c0", "c1", "c2", "c3", "good", "warn", "bad", "ice", "floor"]) ink[name] = style(root, "--" + name);
}
const size = () => [map.clientWidth, map.clientHeight];
const toScreen = (x, y) => { const [w, h] = size(); return [w / 2 + (x - camera.x) * camera.scale, h / 2 - (y - camera.y) * camera.scale]; };
const toFloor = (px, py) => { const [w, h] = size(); return [camera.x + (px - w / 2) / camera.scale, camera.y - (py - h / 2) / camera.scale]; };
const LAW = [["default", "default law", "c1"], ["neural", "paper, neural", "c2"], ["plain", "paper, plain", "c3"]];
const alpha = (colour, a) => colour + Math.round(255 * a).toString(16).padStart(2, "0");

function sharpen(canvas, context) {
  const ratio = window.devicePixelRatio || 1, w = Math.round(canvas.clientWidth * ratio), h = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, w, h);
}

function drawGrid(w, h) {
  const pick = [0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10, 20].find((s) => s * camera.scale > 42) || 50;
  const [left, top] = toFloor(0, 0), [right, bottom] = toFloor(w, h);
  for (const [axis, from, to] of [[0, left, right], [1, bottom, top]]) {
    for (let i = Math.ceil(from / pick); i * pick <= to; i++) {
      const [px, py] = toScreen(i * pick, i * pick);
      pen.strokeStyle = i % 4 === 0 ? ink.grid2 : ink.grid;
      pen.beginPath();
      if (axis === 0) { pen.moveTo(px, 0); pen.lineTo(px, h); } else { pen.moveTo(0, py); pen.lineTo(w, py); }
      pen.stroke();
    }
  }
  const bar = [0.1, 0.25, 0.5, 1, 2, 5, 10].find((s) => s * camera.scale > 60) || 20, y = h - 18;
  pen.strokeStyle = ink.soft; pen.fillStyle = ink.soft; pen.lineWidth = 1.5;
  pen.beginPath(); pen.moveTo(16, y - 4); pen.lineTo(16, y); pen.lineTo(16 + bar * camera.scale, y); pen.lineTo(16 + bar * camera.scale, y - 4); pen.stroke();
  pen.font = "11px system-ui, sans-serif"; pen.fillText(bar < 1 ? Math.round(100 * bar) + " cm" : bar + " m", 20, y - 6);
}

function polyline(points, colour, width, dash = []) {
  if (points.length < 2) return;
  pen.strokeStyle = colour; pen.lineWidth = width; pen.setLineDash(dash); pen.lineJoin = "round"; pen.lineCap = "round";
  pen.beginPath();
  points.forEach(([x, y], i) => { const [px, py] = toScreen(x, y); i ? pen.lineTo(px, py) : pen.moveTo(px, py); });
  pen.stroke(); pen.setLineDash([]);
}

// Trails keep about one point in four pixels.
function trail(pick, colour, width) {
  const rows = history.rows, step = Math.max(1, Math.floor(rows.length / 4000)), points = [];
  let last = null;
  for (let i = 0; i < rows.length; i += step) {
    const p = pick(rows[i]);
    if (!p) continue;
    if (!last || Math.hypot(p.x - last[0], p.y - last[1]) * camera.scale > 3) points.push(last = [p.x, p.y]);
  }
  const end = history.last && pick(history.last);
  if (end) points.push([end.x, end.y]);
  polyline(points, colour, width);
}

function drawRobot(p, colour, solid, base) {
  const [px, py] = toScreen(p.x, p.y), s = camera.scale, half = base.track / 2, r = base.radius;
  pen.save(); pen.translate(px, py); pen.rotate(-p.a);
  const length = 1.25 * base.track * s, width = 0.94 * base.track * s;
  pen.lineWidth = 1.5; pen.strokeStyle = colour; pen.fillStyle = alpha(colour, solid ? 0.22 : 0.08);
  pen.beginPath(); pen.roundRect(-0.5 * length, -width / 2, length, width, 0.2 * width); pen.fill(); pen.stroke();
  if (solid) {
    for (const side of [1, -1]) {
      const slips = status && status.slipping && status.slipping[side === 1 ? 1 : 0];
      pen.fillStyle = slips ? ink.bad : ink.ink;
      const tread = Math.max(3, 0.16 * base.track * s);
      pen.beginPath(); pen.roundRect(-r * s, -side * half * s - tread / 2, 2 * r * s, tread, 0.3 * tread); pen.fill();
    }
  }
  pen.fillStyle = colour; pen.beginPath();
  pen.moveTo(0.26 * length, -0.17 * width); pen.lineTo(0.42 * length, 0); pen.lineTo(0.26 * length, 0.17 * width); pen.closePath(); pen.fill();
  pen.restore();
}

const reach = (base) => Math.max(1.0 * base.track, 26 / camera.scale);
// The goal is turned by a dot at its front, the robot by one behind it: they part where one stands on the other.
const handleOf = (p, base, side = 1) => [p[0] + side * reach(base) * Math.cos(p[2]), p[1] + side * reach(base) * Math.sin(p[2])];
function drawHandle(p, base, colour, side = 1) {
  const [ax, ay] = toScreen(p[0] + 0.5 * (handleOf(p, base, side)[0] - p[0]), p[1] + 0.5 * (handleOf(p, base, side)[1] - p[1])), [bx, by] = toScreen(...handleOf(p, base, side));
  pen.strokeStyle = colour; pen.fillStyle = ink.floor; pen.lineWidth = 2;
  pen.beginPath(); pen.moveTo(ax, ay); pen.lineTo(bx, by); pen.stroke();
  pen.beginPath(); pen.arc(bx, by, 7, 0, 7); pen.fill(); pen.stroke();
}

function drawGoal(p, base) {
  const [px, py] = toScreen(p[0], p[1]), s = camera.scale, length = 1.25 * base.track * s, width = 0.94 * base.track * s;
  pen.save(); pen.translate(px, py); pen.rotate(-p[2]);
  pen.strokeStyle = ink.good; pen.lineWidth = 2; pen.setLineDash([6, 5]); pen.fillStyle = alpha(ink.good, 0.1);
  pen.beginPath(); pen.roundRect(-0.5 * length, -width / 2, length, width, 0.2 * width); pen.fill(); pen.stroke(); pen.setLineDash([]);
  pen.beginPath(); pen.moveTo(-7, 0); pen.lineTo(7, 0); pen.moveTo(0, -7); pen.lineTo(0, 7); pen.stroke();
  pen.restore();
  drawHandle(p, base, ink.good);
}

function drawIce([x0, x1, y0, y1]) {
  const [ax, ay] = toScreen(x0, y1), [bx, by] = toScreen(x1, y0);
  pen.fillStyle = alpha(ink.ice, 0.16); pen.strokeStyle = alpha(ink.ice, 0.7); pen.lineWidth = 1;
  pen.beginPath(); pen.rect(ax, ay, bx - ax, by - ay); pen.fill(); pen.stroke();
  pen.save(); pen.clip(); pen.strokeStyle = alpha(ink.ice, 0.25); pen.beginPath();
  for (let d = ax - (by - ay); d < bx; d += 14) { pen.moveTo(d, by); pen.lineTo(d + (by - ay), ay); }
  pen.stroke(); pen.restore();
}

function drawMap() {
  sharpen(map, pen);
  const [w, h] = size();
  pen.lineWidth = 1; drawGrid(w, h);
  const base = (status && status.base) || { track: 0.35, radius: 0.075 }, now = history.last;
  if (!board.on && status) {
    const [left, top] = toScreen(-FLOOR, FLOOR);
    pen.strokeStyle = ink.soft; pen.strokeRect(left, top, 2 * FLOOR * camera.scale, 2 * FLOOR * camera.scale);
    status.patches.forEach(drawIce);
    polyline(path, ink.soft, 1.5, [2, 6]);
  }
  LAW.slice(1).forEach(([, , c], k) => trail((r) => r.others[k], alpha(ink[c], 0.75), 1.75));
  trail((r) => r.main, ink.c1, 2.25);
  if (!board.on && goal) drawGoal(goal, base);
  if (now) {
    LAW.slice(1).forEach(([, , c], k) => now.others[k] && drawRobot(now.others[k], ink[c], false, base));
    const m = now.main;
    if (!board.on && Math.hypot(m.bx - m.x, m.by - m.y) > 0.03) {
      drawRobot({ x: m.bx, y: m.by, a: m.ba }, ink.soft, false, base);
      const [bx, by] = toScreen(m.bx, m.by); pen.fillStyle = ink.soft; pen.font = "11px system-ui, sans-serif"; pen.fillText("believes to be here", bx + 10, by - 10);
    }
    drawRobot(m, ink.c1, true, base);
    if (!board.on) drawHandle([m.x, m.y, m.a], base, ink.c1, -1);
    if (board.on && Number.isFinite(m.ex)) {
      const c = Math.cos(m.a), s = Math.sin(m.a), g = [m.x + c * m.ex - s * m.ey, m.y + s * m.ex + c * m.ey, m.a + m.ea];
      const [px, py] = toScreen(g[0], g[1]); pen.strokeStyle = ink.good; pen.lineWidth = 2; pen.beginPath(); pen.arc(px, py, 6, 0, 7); pen.stroke();
    }
  }
  if (sketch.line.length) polyline(sketch.line, ink.good, 3);
  if (sketch.ice) drawIce(sketch.ice);
  if (sketch.push) {
    const [a, b] = sketch.push, [ax, ay] = toScreen(...a), [bx, by] = toScreen(...b), d = Math.atan2(by - ay, bx - ax);
    pen.strokeStyle = pen.fillStyle = ink.bad; pen.lineWidth = 3;
    pen.beginPath(); pen.moveTo(ax, ay); pen.lineTo(bx, by); pen.stroke();
    pen.beginPath(); pen.moveTo(bx + 8 * Math.cos(d), by + 8 * Math.sin(d)); pen.lineTo(bx + 8 * Math.cos(d + 2.4), by + 8 * Math.sin(d + 2.4)); pen.lineTo(bx + 8 * Math.cos(d - 2.4), by + 8 * Math.sin(d - 2.4)); pen.fill();
    pen.font = "600 13px system-ui, sans-serif"; pen.fillText(Math.round(force(a, b)) + " N", bx + 12, by - 8);
  }
}

function fit() {
  const points = [];
  const rows = history.rows, step = Math.max(1, Math.floor(rows.length / 300));
  for (let i = Math.max(0, rows.length - 6000); i < rows.length; i += step) if (rows[i].main) points.push([rows[i].main.x, rows[i].main.y]);
  if (history.last) points.push([history.last.main.x, history.last.main.y]);
  else if (status) points.push([status.x, status.y]);
  if (!board.on) { if (goal) points.push(goal); points.push(...path); for (const p of status ? status.patches : []) points.push([p[0], p[2]], [p[1], p[3]]); }
  if (!points.length) return;
  const xs = points.map((p) => p[0]), ys = points.map((p) => p[1]), [w, h] = size(), room = 3 * ((status && status.base.track) || 0.3);
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  camera.x = (x0 + x1) / 2; camera.y = (y0 + y1) / 2;
  camera.scale = Math.max(8, Math.min(420, Math.min(w / (x1 - x0 + room), h / (y1 - y0 + room))));
}
function zoom(factor, px, py) {
  const [w, h] = size(), [x, y] = toFloor(px ?? w / 2, py ?? h / 2);
  camera.scale = Math.max(8, Math.min(3000, camera.scale * factor));
  const [x2, y2] = toFloor(px ?? w / 2, py ?? h / 2);
  camera.x += x - x2; camera.y += y - y2;
}
