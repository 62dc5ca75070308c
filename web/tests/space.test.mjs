/** The view in space: pictures of many colors, doors that open, things that are picked and their parts that move. */
import assert from "node:assert/strict";
import { test } from "node:test";

import { browser, make, opened, server, skip, sound, withBrowserAndServer } from "./support.mjs";

withBrowserAndServer();

/** Returns how many colors the view has, and a sum that another picture does not have. */
function picture(page) {
  return page.evaluate(() => {
    const canvas = document.querySelector('[data-testid="view-3d"] canvas');
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const pen = copy.getContext("2d", { willReadFrequently: true });
    pen.drawImage(canvas, 0, 0);
    const all = pen.getImageData(0, 0, copy.width, copy.height).data;
    const seen = new Set();
    let sum = 0;
    for (let i = 0; i < all.length; i += 4) {
      const color = (all[i] << 16) | (all[i + 1] << 8) | all[i + 2];
      seen.add(color);
      sum = (sum * 31 + color) % 1_000_000_007;
    }
    return { colors: seen.size, sum };
  });
}

/** Waits until models have come and nothing moves, and returns the picture. */
async function still(page) {
  let last = { sum: -1, colors: 0 };
  for (let i = 0; i < 60; i++) {
    const now = await picture(page);
    if (now.sum === last.sum && now.colors > 1) break;
    last = now;
    await page.waitForTimeout(700);
  }
  return last;
}

const calm = (faults) => sound(faults.filter((f) => !f.includes("GPU stall")));

test("the view in space has colors, and a door opens", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await page.getByTestId("stage-3d").click();
  await page.getByTestId("view-3d").locator("canvas").waitFor();
  const shut = await still(page);
  assert.ok(shut.colors > 20, `${shut.colors} colors`);
  await page.getByTestId("doors").click();
  await page.locator('[data-testid="view-3d"][data-open-doors]:not([data-open-doors="0"])').waitFor();
  await page.waitForTimeout(2500);
  assert.notEqual((await picture(page)).sum, shut.sum);
  await page.getByTestId("walk").click();
  await page.keyboard.down("w");
  await page.waitForTimeout(600);
  await page.keyboard.up("w");
  await page.getByTestId("night").click();
  // without a keyboard one walks while a button is held
  const here = await still(page);
  await page.getByTestId("go-s").hover();
  await page.mouse.down();
  await page.waitForTimeout(600);
  await page.mouse.up();
  assert.notEqual((await still(page)).sum, here.sum);
  calm(faults);
  await context.close();
});

test("a thing tells its id, mass and joints, and its door opens at a click", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await page.getByTestId("stage-furnish").click();
  await page.locator(".things button", { hasText: "patient wardrobe" }).first().click();
  await page.getByTestId("stage-3d").click();
  const picked = page.getByTestId("picked");
  await picked.getByText(/patient_wardrobe_1/).waitFor();
  assert.match(await page.getByTestId("picked-mass").innerText(), /^[\d.,]+ kg$/);
  const door = picked.locator("[data-part]").first();
  await page.waitForFunction(() => document.querySelector("[data-part]")?.disabled === false, null, { timeout: 60_000 });
  await page.getByTestId("look-at").click();
  const shut = await still(page);
  await door.click();
  const view = page.getByTestId("view-3d");
  await page.locator('[data-testid="view-3d"][data-open-parts="1"]').waitFor();
  assert.equal(await door.getAttribute("aria-pressed"), "true");
  await page.waitForTimeout(2500);
  assert.notEqual((await picture(page)).sum, shut.sum);
  await door.click();
  await page.locator('[data-testid="view-3d"][data-open-parts="0"]').waitFor();
  assert.equal((await still(page)).sum, shut.sum, "shut again");
  // what is under the pointer is its door, a little off where the leaves meet
  const box = await view.boundingBox();
  await page.mouse.click(box.x + box.width / 2 + 25, box.y + box.height / 2);
  await page.locator('[data-testid="view-3d"][data-open-parts="1"]').waitFor();
  calm(faults);
  await context.close();
});
