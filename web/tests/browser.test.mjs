/** The page as a person uses it, in a real browser against a real server. */
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { mkdtempSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";

import { browser, drawn, make, middle, opened, saved, server, Server, skip, sound, withBrowserAndServer } from "./support.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
withBrowserAndServer();

const id = (name) => `[data-testid="${name}"]`;
const open = (page, stage) => page.getByTestId(`stage-${stage}`).click();

/** Returns an object that stands on the floor and is easy to point at. */
async function bigObject(page) {
  return page.evaluate(() => {
    const all = [...document.querySelectorAll("[data-object-id].object:not(.upper)")];
    const area = (e) => e.getBoundingClientRect().width * e.getBoundingClientRect().height;
    return all.sort((a, b) => area(b) - area(a))[0].getAttribute("data-object-id");
  });
}

/** Returns a wall between two rooms with its middle: the longest that is upright or level on the screen. */
async function innerWall(page) {
  return page.evaluate(() => {
    const world = [...document.querySelectorAll("[data-wall-id]")];
    const outer = document.querySelector(".rooms").getBoundingClientRect();
    const inner = world.filter((w) => {
      const b = w.getBoundingClientRect();
      return b.left > outer.left + 25 && b.right < outer.right - 25 && b.top > outer.top + 25 && b.bottom < outer.bottom - 25;
    });
    const length = (w) => Math.max(w.getBoundingClientRect().width, w.getBoundingClientRect().height);
    const wall = inner.sort((a, b) => length(b) - length(a))[0];
    const b = wall.getBoundingClientRect();
    return { id: wall.dataset.wallId, x: b.x + b.width / 2, y: b.y + b.height / 2, upright: b.height > b.width };
  });
}

async function drag(page, from, by, whileHeld = async () => {}) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 1; i <= 8; i++) await page.mouse.move(from.x + (by.x * i) / 8, from.y + (by.y * i) / 8);
  await whileHeld();
  await page.mouse.up();
}

test("from a sentence to a downloaded archive", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  assert.equal(await page.locator("[data-room-id]").count(), 9);
  assert.ok((await page.locator("[data-object-id]").count()) > 50);
  assert.equal(await page.locator(`${id("asked-got")} [data-ask-id]`).count(), 2);
  assert.ok((await page.locator(`${id("rules-list")} [data-rule-id]`).count()) > 40);
  await page.getByTestId("export").click();
  await page.locator("input[value=nav2]").check();
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByTestId("download").click()]);
  const file = join(mkdtempSync(join(tmpdir(), "d3dgen-zip-")), "world.zip");
  await download.saveAs(file);
  const archive = readFileSync(file).toString("latin1");
  for (const name of ["world.json", "report.json", "plan.svg", "arena/worlds/", "nav2/"]) assert.ok(archive.includes(name), name);
  sound(faults);

  // and back again: the archive is opened as a world
  await open(page, "brief");
  await page.getByTestId("open-file").setInputFiles(file);
  await page.waitForFunction(() => !document.querySelector('[data-testid="undo"]').disabled);
  await page.getByTestId("plan-svg").waitFor();
  assert.equal(await page.locator("[data-room-id]").count(), 9);
  sound(faults);
  await context.close();
});

test("each way to edit is one step, and undo takes it back", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  const object = await bigObject(page);
  const undone = async (act, what) => {
    const was = await drawn(page);
    await act();
    await page.waitForFunction(() => !document.querySelector('[data-testid="undo"]').disabled, null, { timeout: 20_000 }).catch(async () => {
      assert.fail(`${what}: ${await page.getByTestId("notice").innerText().catch(() => "nothing happened")}`);
    });
    if (what !== "lock") assert.notEqual(await drawn(page), was, what);
    await page.getByTestId("undo").click();
    assert.equal(await drawn(page), was, `undo of ${what}`);
    assert.ok(await page.getByTestId("undo").isDisabled(), `${what} is one step`);
    await saved(page);
  };
  const select = async (selector) => {
    const at = await middle(page, selector);
    await page.mouse.click(at.x, at.y);
    await page.getByTestId("inspector").waitFor();
  };
  const chosen = `[data-object-id="${object}"]`;
  for (const name of ["remove", "swap", "lock"]) {
    await select(chosen);
    await undone(() => page.getByTestId(name).click(), name);
  }
  await select(chosen);
  await undone(async () => {
    await page.getByTestId("plan-svg").focus();
    await page.keyboard.press("Delete");
  }, "the key");
  await undone(async () => {
    await drag(page, await middle(page, chosen), { x: 30, y: 12 });
    await anyway(page);
  }, "drag");
  await page.locator("[data-door-id]").first().waitFor();
  await undone(async () => {
    for (const door of await doors(page)) {
      for (const by of [14, -14]) {
        await drag(page, door, door.upright ? { x: 0, y: by } : { x: by, y: 0 });
        await page.waitForTimeout(400);
        if (await page.getByTestId("undo").isEnabled()) return;
      }
    }
  }, "door");
  await undone(async () => {
    for (const window of await windows(page)) {
      for (const by of [16, -16]) {
        await drag(page, window, window.upright ? { x: 0, y: by } : { x: by, y: 0 });
        await page.waitForTimeout(400);
        if (await page.getByTestId("undo").isEnabled()) return;
      }
    }
  }, "window");
  const room = await page.locator("[data-room-id]").first().getAttribute("data-room-id");
  await open(page, "rooms");
  await page.locator(`[data-bubble-id="${room}"]`).click();
  await page.getByTestId("refurnish").waitFor();
  await open(page, "furnish");
  await page.getByTestId("asset-search").fill("waste bin");
  const bin = page.locator(`${id("assets")} li`, { hasText: /bin/i }).first();
  await bin.waitFor();
  await undone(() => bin.locator("button").first().click(), "add");
  sound(faults);
  await context.close();
});

test("several things are selected, dragged along guides with their distances, aligned and duplicated, doors turned, each one step", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page, "open office in Vienna with 8 desks and a meeting room");
  // two loose things of one room, which are easy to point at
  const ids = await page.locator("[data-object-id]").evaluateAll((all) => {
    const loose = all.map((e) => e.dataset.objectId).filter((id) => /waste_bin|recycling|potted_plant|printer|filing_cabinet/.test(id));
    const room = (id) => id.replace(/_(waste|recycling|potted|printer|filing).*$/, "");
    return loose.filter((id) => loose.filter((other) => room(other) === room(id)).length > 1).slice(0, 2);
  });
  assert.equal(ids.length, 2, "two loose things of one room");
  const [first, second] = ids.map((one) => `[data-object-id="${one}"]`);
  const both = async () => {
    const [a, b] = [await middle(page, first), await middle(page, second)];
    await page.mouse.click(a.x, a.y);
    await page.keyboard.down("Shift");
    await page.mouse.click(b.x, b.y);
    await page.keyboard.up("Shift");
    await page.getByText("and 1 more").waitFor();
    return a;
  };
  const was = await drawn(page);
  const back = async (what) => {
    await page.locator(`${id("undo")}:not([disabled])`).waitFor({ timeout: 20_000 });
    assert.notEqual(await drawn(page), was, what);
    await page.getByTestId("undo").click();
    assert.equal(await drawn(page), was, `undo of ${what}`);
    assert.ok(await page.getByTestId("undo").isDisabled(), `${what} is one step`);
  };
  const at = await both();
  await drag(page, at, { x: 26, y: 17 }, async () => {
    await page.getByTestId("dimension").first().waitFor();
    for (const text of await page.getByTestId("dimension").allTextContents()) assert.match(text, /\d/);
  });
  await anyway(page);
  await back("drag of two");
  for (const name of ["align-x", "duplicate", "remove"]) {
    await both();
    await page.getByTestId(name).click();
    await anyway(page);
    await back(name);
  }
  // a door is hung the other way, and turned into the other room
  for (const name of ["door-hinge", "door-room"]) {
    for (const door of await doors(page)) {
      await page.mouse.click(door.x, door.y);
      await page.getByTestId("inspector").filter({ hasText: "Door," }).waitFor();
      if ((await page.getByTestId(name).count()) > 0) break;
    }
    await page.getByTestId(name).click();
    await back(name);
  }
  // what comes near the edge of a neighbor snaps to it, and the guide shows
  const spots = await Promise.all([middle(page, first), middle(page, second)]);
  await drag(page, spots[0], { x: spots[1].x - spots[0].x + 3, y: 0 }, async () => {
    await page.getByTestId("guide").first().waitFor({ state: "attached" }); // a line has no width
    await page.keyboard.press("Escape");
  });
  assert.equal(await drawn(page), was, "Escape lets go");
  sound(faults);
  await context.close();
});

/** Takes what the page offers when no repair keeps the rules. */
async function anyway(page) {
  const button = page.locator(`${id("notice")} button`, { hasText: "Do it anyway" });
  const undo = page.locator(`${id("undo")}:not([disabled])`);
  await Promise.race([button.waitFor({ timeout: 20_000 }), undo.waitFor({ timeout: 20_000 })]);
  if (await button.isVisible()) await button.click();
}

/** Returns where doors with leaves are. */
const doors = (page) => openings(page, "[data-door-id]:has(.leaf[d]:not([d=''])) .hole");
const windows = (page) => openings(page, "[data-window-id] .hole");

async function openings(page, selector) {
  return page.locator(selector).evaluateAll((all) => {
    const boxes = all.map((e) => e.getBoundingClientRect());
    return boxes.map((b) => ({ x: b.x + b.width / 2, y: b.y + b.height / 2, upright: b.height > b.width }));
  });
}

test("a box selects what stands in it, and why a thing stands where it does is said without jargon", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  const room = await page.locator('[data-room-id="patient_room_1"]').boundingBox();
  await page.keyboard.down("Shift");
  await drag(page, { x: room.x + 2, y: room.y + 2 }, { x: room.width - 4, y: room.height - 4 });
  await page.keyboard.up("Shift");
  const chosen = await page.locator("[data-object-id].chosen").evaluateAll((all) => all.map((e) => e.dataset.objectId));
  assert.ok(chosen.length > 5, `${chosen.length} things`);
  const inside = await page.locator("[data-object-id]").evaluateAll((all, box) => {
    const isIn = (b) => b.x + b.width / 2 > box.x && b.x + b.width / 2 < box.x + box.width && b.y + b.height / 2 > box.y && b.y + b.height / 2 < box.y + box.height;
    return all.filter((e) => isIn(e.querySelector(".outline").getBoundingClientRect())).map((e) => e.dataset.objectId);
  }, { x: room.x + 2, y: room.y + 2, width: room.width - 4, height: room.height - 4 });
  assert.deepEqual(chosen.toSorted(), inside.toSorted());
  assert.ok(await page.getByTestId("undo").isDisabled(), "nothing moved");
  const why = await page.getByTestId("why").innerText();
  assert.match(why, /^Why here: this kind of room has it/);
  assert.doesNotMatch(why, /furnishing line|_/);
  sound(faults);
  await context.close();
});

test("everyday things on the furniture are made more and fewer, the plan stays", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page, "flat in Ghent with 2 bedrooms and a living room");
  const plan = () => page.evaluate(() => [...document.querySelectorAll('[data-testid="plan-svg"] :is(.walls, .openings) path')].map((p) => p.getAttribute("d")).join());
  const things = () => page.locator("[data-object-id]").count();
  const was = [await plan(), await things()];
  await open(page, "furnish");
  await page.getByTestId("clutter").selectOption({ label: "many" });
  await page.locator(`${id("undo")}:not([disabled])`).waitFor({ timeout: 60_000 });
  assert.equal(await plan(), was[0], "the plan is the same");
  assert.ok((await things()) > was[1], `${await things()} things, before ${was[1]}`);
  assert.equal(await page.locator(".locked").count(), 0, "nothing is locked by it");
  await page.getByTestId("undo").click();
  assert.deepEqual([await plan(), await things()], was);
  sound(faults);
  await context.close();
});

test("rules that buildings are judged by come before what simulators need, with their figures", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await open(page, "rules");
  const rows = await page.locator(`${id("rules-list")} [data-rule-id]`).evaluateAll((all) => all.map((row) => [row.dataset.ruleId, row.innerText]));
  const at = (rule) => rows.findIndex(([name]) => name === rule);
  assert.ok(at("hospital_de_corridor_width_corridor") >= 0 && at("hospital_de_corridor_width_corridor") < at("not_finite"));
  assert.match(rows[at("hospital_de_corridor_width_corridor")][1], /\d m · at least [\d.]+ m/);
  sound(faults);
  await context.close();
});

test("a rule shows while a wall is dragged, and goes with undo", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  const broken = `${id("rules-list")} [data-standing="broken"]`;
  assert.equal(await page.locator(broken).count(), 0);
  const wall = await innerWall(page);
  await drag(page, wall, wall.upright ? { x: 90, y: 0 } : { x: 0, y: 90 }, async () => {
    await page.getByTestId("live-rule").first().waitFor({ timeout: 10_000 });
    assert.ok((await page.locator(broken).count()) > 0);
    for (const rule of ["wall_gap", "wall_stray"]) {
      assert.equal(await page.locator(`[data-rule-id="${rule}"]`).getAttribute("data-standing"), "held", "of the drawing, not of the plan");
    }
  });
  await anyway(page);
  await page.locator(`${id("undo")}:not([disabled])`).waitFor();
  assert.ok((await page.locator(broken).count()) > 0, "what was done anyway stays marked");
  await page.getByTestId("undo").click();
  assert.equal(await page.locator(broken).count(), 0);
  assert.equal(await page.getByTestId("live-rule").count(), 0);
  sound(faults);
  await context.close();
});

test("reload keeps the work and its history; the language too", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  const object = await bigObject(page);
  const at = await middle(page, `[data-object-id="${object}"]`);
  await page.mouse.click(at.x, at.y);
  await page.getByTestId("remove").click();
  await page.locator(`[data-object-id="${object}"]`).waitFor({ state: "detached" });
  await saved(page);
  const was = await drawn(page);
  await page.locator("header select").selectOption("de");
  await open(page, "rooms");
  await page.getByTestId("room-type").locator("option", { hasText: "Patientenzimmer" }).waitFor({ state: "attached" });
  await open(page, "plan");
  await page.reload();
  await page.getByTestId("plan-svg").waitFor();
  assert.equal(await drawn(page), was);
  assert.equal(await page.getByTestId("stage-brief").innerText(), "Fragen");
  await page.getByTestId("undo").click();
  assert.equal(await page.locator(`[data-object-id="${object}"]`).count(), 1);
  sound(faults);
  await context.close();
});

test("a world is opened by its link, and two tabs that change it are told", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await open(page, "library");
  const worldId = await page.locator(`${id("worlds")} [data-world-id]`).first().getAttribute("data-world-id");
  await page.locator(`${id("worlds")} img`).first().waitFor();
  await page.waitForFunction(() => [...document.images].every((i) => i.complete && i.naturalWidth > 0));
  await open(page, "plan");
  const other = await opened(browser, `${server.url}#plan/${worldId}`);
  await other.page.getByTestId("plan-svg").waitFor();
  await other.page.locator("[data-object-id]").first().waitFor();
  const remove = async (p) => {
    const object = await bigObject(p);
    const at = await middle(p, `[data-object-id="${object}"]`);
    await p.mouse.click(at.x, at.y);
    await p.getByTestId("remove").click();
    await p.locator(`[data-object-id="${object}"]`).waitFor({ state: "detached" });
  };
  await remove(other.page);
  await saved(other.page);
  await remove(page);
  await page.locator('[data-testid="saved"][data-saved="conflict"]').waitFor();
  await page.locator(`${id("notice")} button`, { hasText: "Take up that state" }).click();
  await saved(page);
  assert.equal(await drawn(page), await drawn(other.page));
  // or one's own goes on top, and the other one is in the history
  await remove(other.page);
  await saved(other.page);
  await remove(page);
  await page.locator('[data-testid="saved"][data-saved="conflict"]').waitFor();
  const mine = await drawn(page);
  await page.locator(`${id("notice")} button`, { hasText: "Keep mine on top" }).click();
  await saved(page);
  assert.equal(await drawn(page), mine);
  await open(page, "library");
  await page.locator(`[data-world-id="${worldId}"]`, { hasText: "state 4" }).waitFor();
  sound([...faults, ...other.faults]);
  await other.context.close();
  await context.close();
});

test("a server that is killed and comes back has what was made meanwhile", { skip }, async () => {
  const own = await new Server().start();
  const { page, context } = await opened(browser, own.url);
  await make(page);
  const object = await bigObject(page);
  const at = await middle(page, `[data-object-id="${object}"]`);
  await page.mouse.click(at.x, at.y);
  await own.kill();
  await page.getByTestId("remove").click();
  await page.getByTestId("notice").waitFor();
  await own.start();
  await page.getByTestId("remove").click();
  await page.locator(`[data-object-id="${object}"]`).waitFor({ state: "detached" });
  await saved(page);
  const was = await drawn(page);
  await own.kill();
  await own.start();
  const again = await opened(browser, own.url);
  await open(again.page, "library");
  await again.page.locator(`${id("worlds")} [data-world-id] button`).first().click();
  await again.page.getByTestId("plan-svg").waitFor();
  assert.equal(await drawn(again.page), was);
  await again.context.close();
  await context.close();
  await own.remove();
});

test("a token is asked for, a wrong one is said so, and none is kept", { skip }, async () => {
  const token = "d3dgen_a_token_of_this_test";
  const digest = createHash("sha256").update(token).digest("hex");
  const own = await new Server().start(`[[tokens]]\nname = "somebody"\nscope = "write"\nsha256 = "${digest}"\n`);
  const { page, context, faults } = await opened(browser, own.url);
  await page.getByTestId("token").fill("wrong");
  await page.getByTestId("token-give").click();
  await page.getByTestId("token-wrong").waitFor();
  await page.getByTestId("token").fill(token);
  await page.getByTestId("token-give").click();
  await page.getByTestId("token").waitFor({ state: "detached" });
  await make(page);
  const stored = await page.evaluate(() => JSON.stringify([{ ...localStorage }, { ...sessionStorage }, document.cookie]));
  assert.ok(!stored.includes(token));
  await page.reload();
  await page.getByTestId("token").waitFor();
  sound(faults);
  await context.close();
  await own.remove();
});

/** Opens what a stage shows only when it is asked for. */
const unfold = {
  brief: async (page) => {
    const chip = page.getByTestId("chip").first();
    if ((await chip.getAttribute("aria-expanded")) !== "true") await chip.click();
    await page.getByTestId("wish-more").click();
  },
  rooms: async (page) => {
    await page.locator("[data-bubble-id]").first().click();
    await page.getByTestId("room-card").waitFor();
    // a ring in the meters of the drawing would cover its neighbors
    await page.locator("[data-bubble-id]").first().press("Enter");
    assert.equal(await page.locator("[data-bubble-id]").first().evaluate((e) => getComputedStyle(e).outlineStyle), "none");
  },
  people: async (page) => {
    await page.getByTestId("minutes").fill("1");
    await page.getByTestId("simulate").click();
    await page.getByTestId("crowd-figures").waitFor();
    await page.getByTestId("play").click();
    await page.getByTestId("person").first().locator("summary").click();
  },
  rules: async (page) => {
    await page.getByTestId("own-rules").locator("summary").click();
    await page.locator('[data-rule-id="hospital_de_corridor_width_corridor"] button').first().click();
    await page.getByTestId("amend").click();
    await page.getByTestId("amend-figure").waitFor();
  },
};

test("no serious violation of accessibility, on wide and narrow screens, light and dark", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url, { bypassCSP: true });
  await make(page);
  const serious = async (where) => {
    await page.evaluate(axe);
    const found = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
    const bad = found.violations.filter((v) => ["serious", "critical"].includes(v.impact));
    assert.deepEqual(bad.map((v) => `${where}: ${v.id}: ${v.nodes[0].html}`), []);
  };
  for (const [width, height] of [[1280, 800], [390, 844]]) {
    await page.setViewportSize({ width, height });
    for (const stage of ["brief", "rooms", "plan", "furnish", "people", "rules", "library"]) {
      await open(page, stage);
      await page.waitForTimeout(250);
      await unfold[stage]?.(page);
      await serious(`${stage} at ${width}`);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= width, `${stage} is ${wide} px wide at ${width}`);
    }
    await page.locator("header button[title]").last().click(); // the other theme
    await serious(`other theme at ${width}`);
  }
  sound(faults);
  await context.close();
});

test("a building of 100 rooms stays usable", { skip }, async (t) => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page, "hospital ward with 60 patient rooms, 20 offices and 20 storage rooms in Germany");
  const rooms = await page.locator("[data-room-id]").count();
  assert.ok(rooms >= 100, `${rooms} rooms`);
  await open(page, "rules");
  await page.locator("[data-rule-id]").first().waitFor();
  const begun = Date.now();
  await open(page, "plan");
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(done))));
  const took = Date.now() - begun;
  t.diagnostic(`${rooms} rooms with ${await page.locator("[data-object-id]").count()} objects: the plan is there after ${took} ms`);
  assert.ok(took < 3000, `${took} ms`);
  sound(faults);
  await context.close();
});

test("first paint and size", { skip }, async (t) => {
  // the best of a few first visits: what else the machine does meanwhile is not the page's
  const visits = [];
  for (let i = 0; i < 3; i++) {
    const { page, context, faults } = await opened(browser, server.url);
    visits.push(
      await page.evaluate(async () => {
        await new Promise((done) => setTimeout(done, 600));
        const paint = performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Infinity;
        return { paint, bytes: performance.getEntriesByType("resource").reduce((sum, r) => sum + r.encodedBodySize, 0) };
      }),
    );
    sound(faults);
    await context.close();
  }
  const paint = Math.min(...visits.map((visit) => visit.paint));
  const { bytes } = visits[0];
  t.diagnostic(`first paint ${Math.round(paint)} ms, ${Math.round(bytes / 1000)} kB without the 3D part`);
  assert.ok(paint <= 500, `first paint after ${paint} ms`);
  assert.ok(bytes > 50_000 && bytes <= 600_000, `${bytes} bytes`);
});

test("dragging among 300 things is quick, and so are the rules of an edit", { skip }, async (t) => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page, "open office in Vienna with 30 desks, 4 meeting rooms and a kitchen");
  const objects = await page.locator("[data-object-id]").count();
  assert.ok(objects >= 300, `${objects} objects`);
  const at = await middle(page, `[data-object-id="${await bigObject(page)}"]`);
  await page.evaluate(() => {
    window.frames_ = 0;
    const count = () => (window.frames_++, requestAnimationFrame(count));
    requestAnimationFrame(count);
  });
  const begun = Date.now();
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  for (let i = 0; i < 60; i++) await page.mouse.move(at.x + i, at.y + (i % 7));
  const seconds = (Date.now() - begun) / 1000;
  const frames = await page.evaluate(() => window.frames_);
  await page.keyboard.press("Escape");
  await page.mouse.up();
  const verdicts = await page.evaluate(() =>
    performance
      .getEntriesByType("resource")
      .filter((r) => r.name.endsWith("/CheckWorld"))
      .map((r) => r.duration)
      .sort((a, b) => a - b),
  );
  assert.ok(verdicts.length > 0, "the rules were asked while dragging");
  const usual = verdicts[Math.floor(verdicts.length / 2)];
  t.diagnostic(`${Math.round(frames / seconds)} frames a second, rules back after ${Math.round(usual)} ms among ${objects} things`);
  assert.ok(frames / seconds >= 30, `${frames / seconds} frames a second`);
  sound(faults);
  await context.close();
});
