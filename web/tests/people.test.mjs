/** People and robots: a scenario is moved by the server, played over the plan, and told in figures. */
import assert from "node:assert/strict";
import { test } from "node:test";

import { browser, make, middle, opened, server, skip, sound, withBrowserAndServer } from "./support.mjs";

withBrowserAndServer();

test("everybody walks over the plan, and encounters, distances and conditions are told", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await page.getByTestId("stage-people").click();
  await page.getByTestId("minutes").fill("5");
  await page.getByTestId("simulate").click();
  const figures = page.getByTestId("crowd-figures");
  await figures.waitFor({ timeout: 60_000 });
  assert.match(await figures.innerText(), /Closest encounter\s+[\d.]+ m[^]*delivery robot 1/);
  assert.ok((await figures.locator("[data-condition-id][data-holds]").count()) > 0);
  // it plays by itself, and stands where the time is put
  const at = (selector) => page.locator(selector).evaluate((e) => `${e.getAttribute("cx")} ${e.getAttribute("cy")}`);
  const robot = '[data-robot-id="delivery_robot_1"]';
  await page.getByTestId("play").click();
  const slider = page.locator('input[type="range"]');
  const seen = new Set();
  for (const second of [0, 20, 60, 120, 290]) {
    await slider.fill(String(second));
    seen.add(await at(robot));
  }
  assert.ok(seen.size >= 4, `the robot was at ${seen.size} places`);
  // another world has another future
  await page.getByTestId("stage-plan").click();
  const spot = await middle(page, "[data-object-id].object:not(.upper)");
  await page.mouse.click(spot.x, spot.y);
  await page.getByTestId("remove").click();
  await page.locator('[data-testid="undo"]:not([disabled])').waitFor();
  await page.getByTestId("stage-people").click();
  assert.equal(await figures.count(), 0);
  sound(faults);
  await context.close();
});
