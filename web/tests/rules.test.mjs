/** Rules are changed on the page: shown first, written, listed, taken back; the world is judged by them at once. */
import assert from "node:assert/strict";
import { test } from "node:test";

import { browser, make, opened, server, skip, sound, withBrowserAndServer } from "./support.mjs";

const RULE = "hospital_de_corridor_width_corridor";
withBrowserAndServer();

test("another figure for a rule shows what it changes, is written, listed and taken back", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await page.getByTestId("stage-rules").click();
  const row = page.locator(`[data-rule-id="${RULE}"]`);
  const stands = (standing) => page.locator(`[data-rule-id="${RULE}"][data-standing="${standing}"]`).waitFor();
  await stands("held");
  await row.locator("button").first().click();
  await row.getByTestId("amend").click();
  await row.getByTestId("amend-figure").fill("9");
  assert.match(await row.getByTestId("amend-effect").innerText(), /0 places would keep it, 1 would not/);
  assert.ok(await row.getByTestId("amend-write").isDisabled(), "nothing is written before it was shown");
  await row.getByTestId("amend-why").fill("beds pass each other");
  await row.getByTestId("amend-preview").click();
  assert.match(await row.getByTestId("rule-preview").innerText(), /1\.5 m[^]*9 m/);
  await stands("held");
  await row.getByTestId("amend-write").click();
  await stands("broken");
  assert.match(await row.innerText(), /at least 9 m/);

  await page.getByTestId("own-rules").locator("summary").click();
  const change = page.getByTestId("rule-history").locator("li", { hasText: "beds pass each other" });
  await change.getByRole("button", { name: "Show" }).click();
  assert.match(await change.getByTestId("rule-preview").innerText(), /9 m/);
  await change.getByTestId("history-undo").click();
  await stands("held");
  await change.getByText("taken back").waitFor();
  sound(faults);
  await context.close();
});

test("a rule of one's own is said in a sentence, and the world is held against it", { skip }, async () => {
  const { page, context, faults } = await opened(browser, server.url);
  await make(page);
  await page.getByTestId("stage-rules").click();
  await page.getByTestId("own-rules").locator("summary").click();
  await page.getByTestId("own-rule").fill("patient rooms in our ward have at least 300 m2");
  await page.getByTestId("own-preview").click();
  const own = page.locator('[data-testid="rule-preview"] [data-edit-id]');
  assert.match(await own.innerText(), /patient room[^]*300 m²/);
  const ruleId = await own.getAttribute("data-edit-id");
  assert.equal(await page.locator(`[data-rule-id="${ruleId}"]`).count(), 0);
  await page.getByTestId("own-write").click();
  await page.locator(`[data-rule-id="${ruleId}"]`).waitFor();
  assert.match(await page.locator(`[data-rule-id="${ruleId}"]`).getAttribute("data-standing"), /broken|advice/);
  await page.getByTestId("history-undo").first().click();
  await page.locator(`[data-rule-id="${ruleId}"]`).waitFor({ state: "detached" });
  sound(faults);
  await context.close();
});
