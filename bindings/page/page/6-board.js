// A real board: bytes over Web Serial, or from `sim-host monitor --serve`, decoded by the program.
function boardOn(how) {
  if (!board.on) { board.on = true; history.clear(); path = []; goal = null; wasm.board_forget(); Object.assign(board, { reports: 0, known: false }); document.body.classList.add("board"); }
  $("subtitle").textContent = `a real board, ${how}`;
}
function boardBytes(bytes) {
  send(bytes); wasm.board_take(); wasm.board_status();
  const s = JSON.parse(said());
  const fresh = board.reports === 0 && s.reports > 0;
  if (fresh) board.begun = performance.now();
  Object.assign(board, { reports: s.reports, cause: s.cause }); touched = true;
  if (s.period && !(board.known && board.tick === s.period)) retime(s.period, true);
  put("board-line", `${s.reports} reports, ${s.good} good frames, ${s.bad} bad`);
  if (fresh) { takeReports(); fit(); }
}
let port = null;
async function connect() {
  if (port) { const old = port; port = null; try { await old.reader.cancel(); old.reader.releaseLock(); await old.port.close(); } catch { /* It is gone already. */ } return; }
  if (!navigator.serial) return hint("This browser has no Web Serial; `sim-host monitor PORT --serve 8080` shows this page with any", true);
  try {
    const chosen = await navigator.serial.requestPort();
    await chosen.open({ baudRate: +$("baud").value || 115200, bufferSize: 65536 });
    port = { port: chosen, reader: chosen.readable.getReader() };
    boardOn("over Web Serial"); $("serial").textContent = "Disconnect";
    for (const { reader } = port; ; ) { const { value, done } = await reader.read(); if (done) break; boardBytes(value); }
  } catch (error) { if (error.name !== "NotFoundError") hint(`The line failed: ${error.message}`, true); }
  port = null; $("serial").textContent = "Connect…";
}
$("serial").onclick = connect;
// Only a page that a monitor serves has one to listen to: opened from disk, nothing is asked for.
function listen() {
  if (!/^http:$/.test(location.protocol) || !document.querySelector('meta[name="monitor"]')) return;
  boardOn("by sim-host monitor"); $("serial").disabled = true;
  const events = new EventSource("events");
  events.onmessage = (e) => boardBytes(fromBase64(e.data));
  events.addEventListener("end", () => { events.close(); hint("The line has ended"); });
  events.onerror = () => hint("The monitor does not answer", true);
}

(async () => {
  showTheme(); showPlay(); choose("move");
  await load();
  build();
  begin(START);
  await open(location.hash);
  listen();
  before = performance.now();
  requestAnimationFrame(frame);
})();
