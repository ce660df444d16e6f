"use strict";
// The page of a run, fed live. Takes: messages of rplan view. Gives: `window.live`, which the page asks and tells.
// Leaves alone: how a run is drawn (sim/replay.html).
window.live = (() => {
  const address = location.href.replace(/^http/, "ws").replace(/[?#].*$/, "").replace(/\/?$/, "/") + "live";
  const make = (tag, className, ...parts) => { const node = document.createElement(tag); if (className) node.className = className; node.append(...parts); return node; };
  let socket = null, viewer = null, fixed = {percepts: {}, movable: [], rules: []}, state = {forced: {}, breaks: []}, grip = null, panel = null, tries = 0, again = 0, begin = null;
  const tell = wish => { if (socket && socket.readyState === 1) socket.send(JSON.stringify(wish)); else if (!again) say("the simulation has ended"); };

  const STYLE = `
    #live { padding: 6px 10px 8px; border-top: 1px solid var(--line); max-height: 40%; overflow: auto; flex: none; }
    #live h2 { margin: 4px 0; } #live .row { display: flex; align-items: center; gap: 4px; font: 11px/1.7 var(--mono); }
    #live .row > span { flex: 1; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
    #live .row button { padding: 0 5px; border-color: var(--line); font: 11px/1.7 var(--sans); } #live .row button[aria-pressed=true] { background: var(--act); font-weight: 650; }
    #live .forced > span { color: var(--warn); font-weight: 650; } #live input[type=number] { width: 70px; font: inherit; color: inherit; background: var(--sunk); border: 1px solid var(--line); }
    #said { color: var(--warn); font-weight: 600; } #said.off::before { content: "● "; color: var(--bad); }
    #recording { color: var(--bad); font-weight: 600; white-space: nowrap; overflow: hidden; text-overflow: ellipsis; max-width: 100%; } #recording::before { content: "● "; } #live details summary { cursor: pointer; font-size: 11px; letter-spacing: .06em; text-transform: uppercase; color: var(--dim); font-weight: 650; }
    #code .breaks::after { content: "●"; position: absolute; left: -1px; color: var(--bad); font-size: 12px; } #code .breakable { cursor: pointer; } #code .breakable:hover { background: var(--lit); }`;

  function open(start) {
    document.head.append(make("style", "", STYLE));
    const soon = () => { if (again) { clearTimeout(again); begin(); } };
    addEventListener("online", soon); document.addEventListener("visibilitychange", () => { if (!document.hidden) soon(); });
    return new Promise((_, fail) => {
      begin = () => {
        again = 0; socket = new WebSocket(address);
        socket.onmessage = e => { tries = 0; hear(JSON.parse(e.data), start, fail); };
        socket.onclose = e => e.code === 1001 ? ended() : lost();  // 1001: the server says that it goes
      };
      begin();
    });
  }
  function ended() { document.documentElement.dataset.ended = "yes"; off("the simulation has ended"); }
  function lost() {  // asleep, killed, or too many look: tried again, ever more slowly, at once when the page is looked at
    document.documentElement.dataset.lost = "yes"; again = setTimeout(begin, Math.min(5000, 250 * 2 ** tries++));
    off(viewer ? "connection lost, trying again" : "no connection to the simulation: it has ended, or too many pages look; trying again");
  }
  function off(words) {
    if (viewer) { viewer.running(false); say(words, true); document.getElementById("recording").hidden = true; return; }
    const fault = document.getElementById("fault"); fault.hidden = false; fault.textContent = words;
  }
  function hear(message, start, fail) {
    try {
      if (message.open) {
        if (viewer) return location.reload();  // the run began anew, or the connection did
        document.getElementById("fault").hidden = true;
        fixed = message.fixed; viewer = window.viewer = start(message.open, live); controls(); viewer.seek(viewer.ticks - 1);
      }
      if (message.grow) viewer.grow(message.grow);
      if (message.state) show(message.state);
      if (message.refused) say(message.refused);
    } catch (fault) { fail(fault); }
  }
  function say(words, isOff = false) { const said = document.getElementById("said"); if (said) { said.textContent = words; said.classList.toggle("off", isOff); } }

  function show(now) {
    state = now; viewer.running(now.running); viewer.paced(now.speed); say(now.unwritten || now.said || now.over || "");
    const file = document.getElementById("recording"); file.hidden = !now.recording; file.textContent = `recording ${now.recording}`;
    for (const row of panel.querySelectorAll("[data-percept]")) {
      const value = now.forced[row.dataset.percept]; row.classList.toggle("forced", value !== undefined);
      for (const b of row.querySelectorAll("button")) b.setAttribute("aria-pressed", String(JSON.parse(b.dataset.value) === (value === undefined ? null : value)));
    }
    for (const rule of viewer.rules) viewer.line(rule)?.classList.toggle("breaks", now.breaks.includes(rule.rule));
    for (const b of panel.querySelectorAll("[data-rule]")) b.setAttribute("aria-pressed", String(now.breaks.includes(b.dataset.rule)));
    document.documentElement.dataset.ticks = viewer.ticks;
  }

  function controls() {
    const said = make("span", ""), file = make("span", ""); said.id = "said"; said.setAttribute("role", "status"); file.id = "recording"; file.hidden = true;
    file.title = "each tick is written as it happens; the file is whole when the command has ended (Ctrl-C)"; document.querySelector("header").append(file, said);
    const anew = make("button", "", "↺"); anew.title = "begin anew"; anew.setAttribute("aria-label", "begin anew"); anew.onclick = () => tell({do: "restart"});
    document.querySelector(".transport").insertBefore(anew, document.getElementById("clock"));
    panel = make("div", ""); panel.id = "live";
    panel.append(section("Force percepts", Object.entries(fixed.percepts).map(percept)), section("Stop at rules", fixed.rules.map(rule)));
    document.getElementById("why").append(panel);
    for (const one of viewer.rules) {
      const node = viewer.line(one); if (!node || !fixed.rules.includes(one.rule)) continue;
      node.classList.add("breakable"); node.title = "stop when this rule begins to set something";
      node.onclick = () => tell({do: "break", rule: one.rule, on: !state.breaks.includes(one.rule)});
    }
    for (const key of ["keydown"]) addEventListener(key, e => { if (e.target instanceof HTMLInputElement) e.stopImmediatePropagation(); }, true);
  }
  function section(title, rows) { const node = make("details", "", make("summary", "", title), ...rows); return node; }
  function percept([name, kind]) {
    const row = make("div", "row", make("span", "", name)); row.dataset.percept = name; row.firstChild.title = name;
    const button = (words, value) => { const b = make("button", "", words); b.dataset.value = JSON.stringify(value); b.onclick = () => tell({do: "force", percept: name, value}); return b; };
    if (kind === "truth") row.append(button("as is", null), button("true", true), button("false", false));
    else {
      const given = make("input", ""); given.type = "number"; given.step = "any"; given.placeholder = "number"; given.setAttribute("aria-label", `${name} forced to`);
      given.onchange = () => tell({do: "force", percept: name, value: given.value === "" ? null : Number(given.value)});
      row.append(button("as is", null), given);
    }
    return row;
  }
  function rule(head) {
    const b = make("button", "", "stop"); b.dataset.rule = head; b.setAttribute("aria-pressed", "false");
    b.onclick = () => tell({do: "break", rule: head, on: !state.breaks.includes(head)});
    return make("div", "row", make("span", "", head), b);
  }

  // things that are dragged
  function under(x, y) {
    let best = null, nearest = 14;
    for (const one of viewer.movers) {
      const at = fixed.movable.includes(one.id) && viewer.place(one.id); if (!at) continue;
      const [px, py] = viewer.px(at[0], at[1]), reach = size(one.shape || {}) * viewer.view().scale, off = Math.hypot(px - x, py - y) - reach;
      if (off < nearest) { nearest = off; best = [one, at, x - px, y - py]; }
    }
    return best && nearest < 6 ? best : null;
  }
  const size = shape => shape.circle || Math.min(...(shape.polygon || [[.2, 0]]).map(p => Math.hypot(...p)));
  function place(x, y) { const view = viewer.view(), [ox, oy] = viewer.px(view.x, view.y); return [view.x + (x - grip.dx - ox) / view.scale, view.y - (y - grip.dy - oy) / view.scale, grip.at[2]]; }
  const live = {
    tell, open, held: () => grip && grip.moved ? [grip.one, grip.to] : null,
    grip(x, y) { const hit = viewer && viewer.tick >= viewer.ticks - 1 && under(x, y); if (!hit) return false; const [one, at, dx, dy] = hit; grip = {one, at, dx, dy, to: at, moved: false}; return true; },
    drag(x, y) { if (!grip) return false; grip.to = place(x, y); grip.moved = true; return true; },
    drop(done) { if (grip && grip.moved && done) tell({do: "move", thing: grip.one.id, pose: grip.to}); grip = null; },
  };
  return live;
})();
