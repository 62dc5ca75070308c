/** Makes the pictures of docs/web.md anew: `npm run --prefix web screenshots`. */
import { resolve } from "node:path";

import { launch, make, opened, Server } from "./support.mjs";

const folder = resolve("../docs/images");
const server = await new Server().start();
const browser = await launch();
const { page } = await opened(browser, server.url);
const shot = (name) => page.screenshot({ path: `${folder}/web-${name}.png` });
const open = async (stage, wait = 800) => {
  await page.getByTestId(`stage-${stage}`).click();
  await page.waitForTimeout(wait);
};

await make(page);
await shot("plan");
const wall = await page.evaluate(() => {
  const inner = [...document.querySelectorAll("[data-wall-id]")].map((w) => w.getBoundingClientRect());
  const outer = document.querySelector(".rooms").getBoundingClientRect();
  const free = inner.filter((b) => b.left > outer.left + 25 && b.right < outer.right - 25 && b.top > outer.top + 25 && b.bottom < outer.bottom - 25);
  const wall = free.sort((a, b) => Math.max(b.width, b.height) - Math.max(a.width, a.height))[0];
  return { x: wall.x + wall.width / 2, y: wall.y + wall.height / 2, upright: wall.height > wall.width };
});
await page.mouse.move(wall.x, wall.y);
await page.mouse.down();
for (let i = 1; i <= 10; i++) await page.mouse.move(wall.x + (wall.upright ? 5 * i : 0), wall.y + (wall.upright ? 0 : 5 * i));
await page.getByTestId("live-rule").first().waitFor();
await page.waitForTimeout(500);
await shot("rule");
await page.keyboard.press("Escape");
await page.mouse.up();
await open("brief");
await page.getByTestId("chip").filter({ hasText: "8 rooms" }).click();
await shot("ask");
await open("rooms");
await page.locator("[data-bubble-id]").nth(1).click();
await shot("rooms");
await open("people");
await shot("tasks");
await page.getByTestId("simulate").click();
await page.getByTestId("crowd-figures").waitFor();
await page.getByTestId("play").click();
await page.locator('input[type="range"]').fill("120");
await shot("people");
await open("furnish", 3000);
await shot("furnish");
await open("rules");
const rule = page.locator('[data-rule-id="hospital_de_corridor_width_corridor"]');
await rule.locator("button").first().click();
await rule.getByTestId("amend").click();
await rule.getByTestId("amend-figure").fill("2.6");
await rule.getByTestId("amend-preview").click();
await rule.getByTestId("rule-preview").waitFor();
await shot("rules");
await open("library", 3000);
await shot("library");
await open("furnish");
await page.getByTestId("plan-svg").press("Escape");
await page.locator(".things button", { hasText: "patient wardrobe" }).first().click();
await open("3d", 20_000);
await page.getByTestId("look-at").click();
await page.locator("[data-part]").first().click();
await page.waitForTimeout(3000);
await shot("3d");
await browser.close();
await server.remove();
