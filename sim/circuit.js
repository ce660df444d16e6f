"use strict";
// The part of a circuit that a person can read at once. Takes: the circuit in few letters (`compact`, inspect_circuit_part.py), and where to draw.
// Gives: `circuitPart(host, made, first)`: gates nearest to an output, percept, register or gate; a click on a cut wire goes on from there.
// `light` lights the wires of a tick. Leaves alone: what the bits of a tick are. What is cut where is as in inspect_circuit_part.py.
window.circuitPart = (host, made, first = () => "") => {
  const {ops, a, b} = made, count = ops.length, gates = [...ops].filter(op => "nao".includes(op)).length, isGate = k => ops[k] === "n" || ops[k] === "a" || ops[k] === "o";
  const reads = k => !isGate(k) ? [] : b[k] < 0 || a[k] === b[k] ? [a[k]] : [a[k], b[k]], readers = Array.from({length: count}, () => []);
  for (let k = 0; k < count; k++) for (const one of reads(k)) readers[one].push(k);
  const ends = [...made.outputs.map(([name, net, line]) => ({name, net, tip: line ? `${name} at line ${line}` : name})), ...made.registers.map(([name, net]) => ({name: `next ${name}`, net, tip: `what becomes of ${name}`}))];
  const name = k => ops[k] === "i" ? made.inputs[a[k]] : ops[k] === "r" ? `register ${made.registers[a[k]][0]}` : ops[k] === "c" ? (a[k] ? "true" : "false") : `gate ${k}`;
  const many = (n, what) => `${n.toLocaleString("en")} ${what}${n === 1 ? "" : "s"}`, byNumber = (x, y) => x - y;

  // --- which gates ---------------------------------------------------------------------------------
  function cut({nets, forwards, only}, most) {
    const shown = new Set(), seen = new Set(nets); let level = [...seen].sort(byNumber);
    while (level.length && shown.size < most) {
      for (const k of level) if (isGate(k) && shown.size < most) shown.add(k);
      const beyond = new Set(); for (const k of level) for (const one of forwards ? readers[k] : reads(k)) if (isGate(one) && !seen.has(one)) beyond.add(one);
      level = [...beyond].sort(byNumber); for (const k of level) seen.add(k);
    }
    const all = new Set([...nets, ...shown]); for (const k of shown) for (const one of reads(k)) all.add(one);
    const open = new Set(forwards ? [...nets, ...shown] : nets), out = (only || ends.filter(one => open.has(one.net))).slice(0, 200), more = [];
    if (!only) for (const k of open) { const away = readers[k].filter(one => !shown.has(one)).length; if (away) more.push({name: `▸ ${away.toLocaleString("en")} more`, net: k, tip: `${many(away, "more gate")} read${away === 1 ? "s" : ""} ${name(k)}: click to see them`, go: true}); }
    return {shown, numbers: [...all].sort(byNumber), ends: [...out, ...more]};
  }
  function behind(net) { const seen = new Set([net]), left = [net]; while (left.length) for (const one of reads(left.pop())) if (isGate(one) && !seen.has(one)) { seen.add(one); left.push(one); } return seen.size; }

  // --- where they stand: columns by depth, sorted and spaced by the mean of their neighbours, as svg.py does ---------
  const COLUMN = 58, ROW = 26, BEND = 11, LETTER = 6.65, MARGIN = 16, SWEEPS = 24, PULL = .97;
  const short = (text, most, tail = 0) => text.length <= most ? text : `${text.slice(0, most - 1 - tail)}…${text.slice(text.length - tail)}`;
  const mean = (nodes, other) => nodes.length ? PULL * nodes.reduce((s, n) => s + n.y, 0) / nodes.length : PULL * other;
  function space(column, wished) {
    const offsets = [], blocks = [];
    column.forEach((node, k) => {
      offsets.push(k ? offsets[k - 1] + (node.room + column[k - 1].room) / 2 : 0); blocks.push([wished[k] - offsets[k], 1]);
      for (let n = blocks.length; n > 1 && blocks[n - 2][0] / blocks[n - 2][1] > blocks[n - 1][0] / blocks[n - 1][1]; n--) { const [total, size] = blocks.pop(); blocks[n - 2][0] += total; blocks[n - 2][1] += size; }
    });
    let k = 0; for (const [total, size] of blocks) for (let n = 0; n < size; n++, k++) column[k].y = total / size + offsets[k];
  }
  function arrange(columns) {
    for (const column of columns) space(column, column.map(() => 0));
    for (let sweep = 0; sweep < SWEEPS; sweep++) {
      const wish = n => mean(sweep >= SWEEPS - 6 ? [...n.before, ...n.after] : sweep % 2 ? n.after : n.before, n.y);
      for (const column of sweep % 2 ? [...columns].reverse() : columns) {
        const sorted = column.map((node, k) => [wish(node), k, node]).sort((x, y) => x[0] - y[0] || x[1] - y[1]);
        column.splice(0, column.length, ...sorted.map(one => one[2])); space(column, sorted.map(one => one[0]));
      }
    }
  }
  function layout(part) {
    const node = (net, room, more) => ({net, room, column: 0, y: 0, x: 0, before: [], after: [], ...more}), at = new Map(part.numbers.map(k => [k, node(k, ROW, {kind: "cell"})])), inside = k => part.shown.has(k) ? reads(k) : [];
    for (const k of part.numbers) at.get(k).column = 1 + Math.max(-1, ...inside(k).map(one => at.get(one).column));
    let last = 1 + Math.max(0, ...[...at.values()].map(n => n.column)); const latest = new Map(part.numbers.map(k => [k, last]));
    for (const k of [...part.numbers].reverse()) { at.get(k).column = latest.get(k) - 1; for (const one of inside(k)) latest.set(one, Math.min(latest.get(one), latest.get(k) - 1)); }
    const least = Math.min(...[...at.values()].map(n => n.column)); for (const n of at.values()) n.column -= least; last -= least;
    const outs = part.ends.map(end => node(end.net, ROW, {kind: "end", column: last, end})), bends = [], chains = new Map(), reading = new Map(part.numbers.map(k => [k, []]));
    for (const k of part.numbers) for (const one of isGate(k) && part.shown.has(k) ? (b[k] < 0 ? [a[k]] : [a[k], b[k]]) : []) reading.get(one).push(at.get(k));
    for (const n of outs) reading.get(n.net).push(n);
    const join = (left, right) => { left.after.push(right); right.before.push(left); };
    for (const k of part.numbers) {
      const chain = [at.get(k)], to = reading.get(k), from = chain[0].column;
      for (let c = from + 1; c < Math.max(...to.map(n => n.column), 0); c++) { const bend = node(k, BEND, {kind: "bend", column: c}); bends.push(bend); join(chain.at(-1), bend); chain.push(bend); }
      for (const n of to) join(chain[n.column - 1 - from], n);
      chains.set(k, chain);
    }
    const columns = Array.from({length: last + 1}, () => []), rooms = new Array(last + 1).fill(0), places = []; for (const n of [...at.values(), ...bends, ...outs]) columns[n.column].push(n);
    for (const n of at.values()) if (!part.shown.has(n.net)) { n.label = isGate(n.net) ? `◂ ${behind(n.net).toLocaleString("en")} more` : short(ops[n.net] === "r" ? made.registers[a[n.net]][0] : name(n.net), 36, 12); rooms[n.column] = Math.max(rooms[n.column], n.label.length * LETTER); }
    arrange(columns);
    columns.forEach((column, c) => { places.push(c ? places[c - 1] + COLUMN + rooms[c] : MARGIN + 14 + rooms[0]); for (const n of column) n.x = places[c]; });
    const every = columns.flat(), top = Math.min(...every.map(n => n.y)); for (const n of every) n.y += ROW - top;
    const width = places[last] + 24 + LETTER * Math.max(0, ...outs.map(n => short(n.end.name, 60).length)) + MARGIN;
    return {at, outs, chains, rooms, width, height: Math.max(...every.map(n => n.y)) + ROW};
  }

  // --- the drawing -----------------------------------------------------------------------------------
  const NS = "http://www.w3.org/2000/svg";
  function node(tag, given, ...parts) { const made = document.createElementNS(NS, tag); for (const key in given) made.setAttribute(key, given[key]); made.append(...parts); return made; }
  const el = (tag, given, ...parts) => { const made = document.createElement(tag); Object.assign(made, given); made.append(...parts); return made; };
  const f = x => x.toFixed(1), SHAPES = {n: (x, y) => `M${f(x - 11)} ${f(y - 7)}l16 7l-16 7Zm16 7a3 3 0 1 0 6 0a3 3 0 1 0 -6 0`, a: (x, y) => `M${f(x - 11)} ${f(y - 9)}h11a9 9 0 0 1 0 18h-11Z`, o: (x, y) => `M${f(x - 13)} ${f(y - 9)}h8q10 0 16 9q-6 9 -16 9h-8q6 -9 0 -18Z`};
  let lines = new Map(), painted = new Map();
  function group(net, kind, tip, ...parts) { const g = node("g", {class: kind, "data-net": net}, node("title", {}, tip), ...parts); if (!lines.has(net)) lines.set(net, []); lines.get(net).push(g); return g; }
  function wire(k, {chains, rooms}) {
    const parts = [];
    for (const from of chains.get(k)) for (const to of from.after) {
      const shift = to.kind === "cell" && to.before.length === 2 ? 10 * to.before.indexOf(from) - 5 : 0;
      const x = from.x + (from.kind === "bend" ? 0 : 11), end = to.x - (to.kind === "bend" ? 0 : 11), in_ = end - rooms[to.column], mid = COLUMN * .45, y = to.y + shift;
      parts.push(`M${f(x)} ${f(from.y)}C${f(x + mid)} ${f(from.y)} ${f(in_ - mid)} ${f(y)} ${f(in_)} ${f(y)}H${f(end)}`);
    }
    return group(k, "wire", name(k), node("path", {class: "wire", d: parts.join("")}));
  }
  const OPS = {n: "not", a: "and", o: "or"};
  function cell(n, part, roots) {
    const k = n.net, root = roots.includes(k) ? " root" : "";
    if (part.shown.has(k)) { const g = group(k, `cell go${root}`, `${OPS[ops[k]]}, gate ${k}, read by ${many(readers[k].length, "gate")}: click to go on from here`, node("path", {class: `gate ${OPS[ops[k]]}`, d: SHAPES[ops[k]](n.x, n.y)})); g.dataset.way = "back"; return g; }
    const label = node("text", {x: f(n.x - 6), y: f(n.y + 4), "text-anchor": "end"}, n.label), dot = node("circle", {class: "gate", cx: f(n.x + 6), cy: f(n.y), r: 5});
    if (!isGate(k)) { const g = group(k, `cell go${root}`, `${name(k)}, read by ${many(readers[k].length, "gate")}: click to see what it has a say in`, dot, label); g.dataset.way = "on"; return g; }
    const g = group(k, "cell stub go", `${OPS[ops[k]]}, gate ${k}, the ${many(behind(k), "gate")} behind this wire: click to go on from here`, dot, label); g.dataset.way = "back"; press(g); return g;
  }
  function end(n) {
    const dot = node("rect", {class: "gate", x: f(n.x - 11), y: f(n.y - 5), width: 10, height: 10}), g = group(n.net, `end go${n.end.go ? " stub" : ""}`, n.end.tip, dot, node("text", {x: f(n.x + 6), y: f(n.y + 4)}, short(n.end.name, 60)));
    g.dataset.way = n.end.go ? "on" : "back"; g.dataset.end = n.end.go ? "" : n.end.name; if (n.end.go) press(g); return g;
  }
  function press(g) { g.setAttribute("tabindex", "0"); g.setAttribute("role", "button"); }

  // --- the choice ------------------------------------------------------------------------------------
  const box = el("input", {type: "search", placeholder: "output, percept, register, gate 12", ariaLabel: "what of the circuit to show"}), list = el("div", {className: "choices", hidden: true}), paper = el("div", {className: "paper", tabIndex: 0}), said = el("span", {className: "said"});
  said.setAttribute("role", "status");
  const button = (words, title, onclick) => el("button", {textContent: words, title, onclick}), back = button("←", "back to what was shown before", () => { const was = before.pop(); if (was) { here = was; show(); } }); back.setAttribute("aria-label", "back");
  const makes = button("what makes it", "the gates that it is made of, nearest first", () => turn(false)), has = button("what reads it", "the gates that it has a say in, nearest first", () => turn(true)), fewer = button("−", "fewer gates", () => grow(.5)), more = button("+", "more gates", () => grow(2));
  const bar = el("div", {className: "bar"}, back, el("span", {className: "seek"}, box, list), makes, has, el("span", {className: "pair"}, fewer, more), said), LEAST = 25, MOST = 800;
  let here = null, before = [], most = 100, on = new Uint8Array(count), known = false;
  function go(to) { if (here) before.push(here); if (before.length > 200) before.shift(); here = to; show(); }
  function turn(forwards) { if (here.forwards !== forwards) go({...here, forwards, only: forwards ? null : here.outs || null}); }
  function grow(by) { most = Math.max(LEAST, Math.min(MOST, most * by)); show(); }
  const output = (says, outs) => ({says, nets: [...new Set(outs.map(one => one.net))], forwards: false, only: outs, outs}), source = net => ({says: name(net), nets: [net], forwards: !isGate(net), only: null});
  const channel = one => one.name.slice(0, one.name.indexOf("=") < 0 ? undefined : one.name.indexOf("="));
  const every = [...made.outputs.keys()].map(k => ends[k]), choices = [];
  for (const one of every) choices.push([one.name, "output", () => output(one.name, [one]), one.net]);
  for (const called of new Set(every.map(channel))) { const outs = every.filter(one => channel(one) === called); if (outs.length > 1) choices.push([called, many(outs.length, "value"), () => output(called, outs), -1]); }
  for (let k = 0; k < count; k++) if (ops[k] === "i" || ops[k] === "r") choices.push([name(k), ops[k] === "i" ? "percept" : "", () => source(k), k]);
  for (const one of ends.slice(made.outputs.length)) choices.push([one.name, "register", () => output(one.name, [one]), one.net]);
  function matching(text) {
    const wanted = text.trim().toLowerCase(), number = /^(?:gate|net)?\s*(\d+)$/.exec(wanted), found = choices.filter(([called]) => called.toLowerCase().includes(wanted));
    found.sort((x, y) => (y[0].toLowerCase() === wanted) - (x[0].toLowerCase() === wanted));
    return number && +number[1] < count ? [[name(+number[1]), OPS[ops[+number[1]]] || "", () => source(+number[1]), +number[1]], ...found] : found;
  }
  function offer() {
    const found = matching(box.value), FEW = 40; list.hidden = false;
    list.replaceChildren(...found.slice(0, FEW).map(([called, kind, make, net]) => { const one = el("button", {title: called, onclick: () => { close(); go(make()); }}, el("span", {}, called), el("i", {}, kind)); one.classList.toggle("on", known && net >= 0 && !!on[net]); return one; }));
    if (found.length > FEW || !found.length) list.append(el("p", {}, found.length ? `${found.length - FEW} more: type on` : "nothing in the circuit is called so"));
  }
  function close() { list.hidden = true; box.value = ""; }
  box.oninput = offer; box.onfocus = offer; box.onkeydown = e => {
    e.stopPropagation();
    if (e.key === "Enter") { const [one] = matching(box.value); if (one) { close(); box.blur(); go(one[2]()); } }
    if (e.key === "ArrowDown") { e.preventDefault(); list.querySelector("button")?.focus(); }
    if (e.key === "Escape") { close(); box.blur(); }
  };
  list.onkeydown = e => { const by = {ArrowDown: "nextElementSibling", ArrowUp: "previousElementSibling"}[e.key]; if (by) (document.activeElement[by] || box).focus(); if (e.key === "Escape") { close(); box.focus(); list.hidden = true; } if (by || e.key === "Escape" || e.key === "Enter" || e.key === " ") e.stopPropagation(); if (by) e.preventDefault(); };
  addEventListener("pointerdown", e => { if (!list.hidden && !bar.querySelector(".seek").contains(e.target)) list.hidden = true; });
  function pressed(g) {
    const net = +g.dataset.net, out = g.dataset.end && ends.find(one => one.name === g.dataset.end && one.net === net);
    go(out ? output(out.name, [out]) : {...source(net), forwards: g.dataset.way === "on"});
  }
  paper.addEventListener("click", e => { const g = e.target.closest(".go"); if (g) pressed(g); });
  paper.addEventListener("keydown", e => { const g = e.target.closest(".stub"); if (g && (e.key === "Enter" || e.key === " ")) { e.preventDefault(); e.stopPropagation(); pressed(g); } });

  function show() {
    const part = cut(here, most), made = layout(part); lines = new Map(); painted = new Map();
    const sheet = node("svg", {width: Math.ceil(made.width), height: Math.ceil(made.height), viewBox: `0 0 ${Math.ceil(made.width)} ${Math.ceil(made.height)}`, role: "img", "aria-label": `the circuit of ${here.says}`});
    for (const k of part.numbers) if (made.at.get(k).after.length) sheet.append(wire(k, made));
    for (const k of part.numbers) sheet.append(cell(made.at.get(k), part, here.nets));
    for (const one of made.outs) sheet.append(end(one));
    paper.replaceChildren(sheet);
    const whole = part.shown.size === reach(here), all = `${part.shown.size.toLocaleString("en")} of ${many(gates, "gate")}`;
    said.replaceChildren(el("b", {}, all), `: ${here.forwards ? "what reads" : "what makes"} ${here.says}${whole ? ", all of it" : ", nearest first; ◂ ▸ go on"}`); said.title = said.textContent;
    back.disabled = !before.length; fewer.disabled = most <= LEAST; more.disabled = whole || most >= MOST; makes.setAttribute("aria-pressed", String(!here.forwards)); has.setAttribute("aria-pressed", String(here.forwards));
    if (known) paint();
    const by = Math.max(.8, Math.min(1.2, (paper.clientWidth - 4) / made.width)), roots = here.nets.map(k => made.at.get(k)), middle = key => by * roots.reduce((sum, n) => sum + n[key], 0) / roots.length;
    sheet.setAttribute("width", made.width * by); sheet.setAttribute("height", made.height * by);
    paper.scrollTo(middle("x") - paper.clientWidth * (here.forwards ? .3 : .55), middle("y") - paper.clientHeight / 2);
    host.dataset.shown = here.says;
  }
  function reach({nets, forwards}) { const seen = new Set(nets), left = [...nets]; while (left.length) { const k = left.pop(); for (const one of forwards ? readers[k] : reads(k)) if (isGate(one) && !seen.has(one)) { seen.add(one); left.push(one); } } return [...seen].filter(isGate).length; }
  function light(bits, kept) {  // what each net carries: a gate reads smaller nets only
    for (let k = 0; k < count; k++) { const op = ops[k]; on[k] = op === "a" ? on[a[k]] & on[b[k]] : op === "o" ? on[a[k]] | on[b[k]] : op === "n" ? 1 - on[a[k]] : op === "i" ? +(bits[a[k]] === "1") : op === "r" ? +(kept[a[k]] === "1") : a[k]; }
    known = true; if (here) paint();
  }
  function paint() { for (const [net, groups] of lines) if (painted.get(net) !== on[net]) { painted.set(net, on[net]); for (const g of groups) g.classList.toggle("on", on[net] === 1); } }
  function open(text) { const called = text && matching(text).find(([one]) => one === text || one === `(${text})`) || (text && matching(text)[0]); if (called) go(called[2]()); return !!called; }
  function begin() { if (!here) open(first()) || go(output(...(one => [one.name, [one]])(every.find(one => isGate(one.net) && one.name !== "hole") || every[0]))); else show(); }

  host.append(el("style", {textContent: `
    .part { display: flex; flex-direction: column; height: 100%; min-height: 0; } .part .bar { flex: none; display: flex; flex-wrap: wrap; align-items: center; gap: 4px 6px; padding: 6px; border-bottom: 1px solid var(--line); font: 12px/1.4 var(--sans); }
    .part .paper { flex: 1; min-height: 0; overflow: auto; overscroll-behavior: contain; } #part .paper { min-height: min(50vh, 345px); } @media (max-width: 900px) { .part .paper { min-height: min(50vh, 345px); } } .part .paper svg { display: block; margin: auto; } .part .paper:focus-visible { outline-offset: -2px; }
    .part button { padding: 2px 8px; border: 1px solid var(--line); border-radius: 5px; } .part button[aria-pressed=true] { background: color-mix(in srgb, var(--accent) 20%, transparent); } .part button:disabled { opacity: .4; cursor: default; } .part .pair { display: flex; gap: 2px; }
    .part .said { flex: 1 1 200px; min-width: 0; color: var(--dim); overflow-wrap: anywhere; } .part .said b { color: var(--text); } .part .seek { position: relative; flex: 0 1 250px; } .part .seek input { width: 100%; font: inherit; color: inherit; background: var(--bg); border: 1px solid var(--line); border-radius: 5px; padding: 3px 7px; }
    .part .choices { position: absolute; z-index: 3; top: 100%; left: 0; width: min(440px, 86vw); max-height: min(50vh, 330px); overflow: auto; background: var(--panel); border: 1px solid var(--line); border-radius: 5px; box-shadow: 0 6px 20px #0004; } .part .choices p { margin: 4px 8px; color: var(--dim); }
    .part .choices button { display: flex; gap: 8px; width: 100%; border: 0; border-radius: 0; text-align: left; font: 12px/1.6 var(--mono); } .part .choices span { flex: 1; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; } .part .choices i { font-style: normal; color: var(--dim); } .part .choices .on span { color: var(--good); font-weight: 650; } .part .choices button:focus-visible, .part .choices button:hover { background: color-mix(in srgb, var(--accent) 16%, transparent); outline: none; }
    .part .go { cursor: pointer; } .part .go:hover > .gate, .part .go:focus-visible > .gate { stroke: var(--accent); stroke-width: 2.4; } .part .go:focus-visible { outline: none; } .part .stub > text { fill: var(--accent) !important; } .part .stub > .gate { stroke-dasharray: 2.5 2; } .part .stub:hover > text, .part .stub:focus-visible > text { text-decoration: underline; } .part .root > .gate { stroke: var(--accent) !important; stroke-width: 2.4 !important; }`}), el("div", {className: "part"}, bar, paper));
  return {light, open, begin, focus: () => box.focus(), values: () => on};
};
