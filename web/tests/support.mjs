/** A real server, a real browser, and what every test looks at afterwards: errors on the console and breaches of the policy. */
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { extname, join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { after, before } from "node:test";

import { chromium } from "playwright-core";

/** Where browsers lie; D3DGEN_BROWSER names another. */
const BROWSERS = [process.env.D3DGEN_BROWSER, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const PROGRAM = resolve(process.env.D3DGEN ?? "../target/debug/d3dgen");
export const PROMPT = "hospital ward with 8 rooms in Germany, for a delivery robot";

export const executable = BROWSERS.find((path) => path && existsSync(path));
/** Why tests in a browser do not run here; false where they do. */
export const skip = executable ? false : "no browser is here";

/** Folder of a built page that is shown instead of the one in the program, so that a change needs no new program. */
const PAGE = process.env.D3DGEN_PAGE;
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };

/** Servers that were not removed yet: those of tests that failed too. */
const running = new Set();

/** A `d3dgen serve` with a folder of its own. */
export class Server {
  #child;
  #home = mkdtempSync(join(tmpdir(), "d3dgen-web-"));
  #port = 0;

  /** Starts a server, on the same port as before when it is started again. */
  async start(settings = "") {
    const config = join(this.#home, "server.toml");
    writeFileSync(config, `version = 1\nlog_level = "error"\n${settings}`);
    const flags = ["serve", "--config", config, "--listen", `127.0.0.1:${this.#port}`, "--data-dir", join(this.#home, "data")];
    running.add(this);
    this.#child = spawn(PROGRAM, flags, { stdio: ["ignore", "pipe", "inherit"], env: { ...process.env, D3DGEN_STORE: "" } });
    for await (const line of createInterface(this.#child.stdout)) {
      const address = /^listening on .*:(\d+)$/.exec(line);
      if (!address) continue;
      this.#port = Number(address[1]);
      return this;
    }
    throw new Error("the server ended before it listened");
  }

  get url() {
    return `http://127.0.0.1:${this.#port}/`;
  }

  /** Ends the server as a power cut would. */
  async kill() {
    if (this.#child.exitCode !== null || this.#child.signalCode !== null) return;
    const ended = new Promise((done) => this.#child.once("exit", done));
    this.#child.kill("SIGKILL");
    await ended;
  }

  async remove() {
    running.delete(this);
    await this.kill();
    rmSync(this.#home, { recursive: true, force: true });
  }
}

/** Runs the program to its end. */
export function runProgram(...flags) {
  execFileSync(PROGRAM, flags, { stdio: "ignore", env: { ...process.env, D3DGEN_STORE: "" } });
}

export function launch() {
  return chromium.launch({ executablePath: executable, args: ["--no-sandbox", "--enable-unsafe-swiftshader"] });
}

/** What the tests of a file share: there from the first of them on, see `withBrowserAndServer`. */
export let browser;
export let server;

/** Has a browser and a server for the tests of the file that calls it, and ends both after them. */
export function withBrowserAndServer() {
  before(async () => {
    if (skip) return;
    browser = await launch();
    server = await new Server().start();
  });
  after(async () => {
    await browser?.close();
    await Promise.all([...running].map((one) => one.remove()));
  });
}

/** Opens the page in a context of its own; `faults` collects what must not be. */
export async function opened(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, locale: "en-US", ...options });
  const faults = [];
  await watch(context, faults);
  if (PAGE) await context.route((address) => fileOf(address) !== undefined, show);
  const page = await context.newPage();
  await page.goto(url);
  return { context, page, faults };
}

function fileOf(address) {
  const path = join(PAGE, address.pathname === "/" ? "index.html" : address.pathname);
  return extname(path) in TYPES && existsSync(path) ? path : undefined;
}

/** Answers with a file of the folder, under the policy that the server sends with its own page. */
async function show(route) {
  const address = new URL(route.request().url());
  const path = fileOf(address);
  const headers = { "content-type": TYPES[extname(path)], "content-security-policy": await policyOf(address.origin) };
  // a page that was closed meanwhile wants no answer
  await route.fulfill({ body: readFileSync(path), headers }).catch(() => {});
}

const policies = new Map();
function policyOf(origin) {
  if (!policies.has(origin)) policies.set(origin, fetch(origin).then((own) => own.headers.get("content-security-policy") ?? ""));
  return policies.get(origin);
}

async function watch(context, faults) {
  await context.addInitScript(() => {
    addEventListener("securitypolicyviolation", (e) => console.error(`CSP: ${e.violatedDirective} ${e.blockedURI}`));
  });
  context.on("page", (page) => {
    page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
    page.on("pageerror", (error) => faults.push(error.message));
  });
}

/** Makes a world and waits for its plan. */
export async function make(page, prompt = PROMPT) {
  await page.getByTestId("prompt").fill(prompt);
  await page.getByTestId("generate").click();
  await built(page);
  await saved(page);
}

/** Waits until a world is whole on the plan. */
export async function built(page) {
  await page.getByTestId("plan-svg").waitFor({ timeout: 60_000 });
  await page.locator("progress").waitFor({ state: "detached", timeout: 120_000 });
}

/** Waits until the server has what the page has. */
export async function saved(page) {
  await page.locator('[data-testid="saved"][data-saved="saved"]').waitFor({ timeout: 30_000 });
}

/** Returns the plan as it is drawn: the same for the same world, whatever is selected. */
export function drawn(page) {
  return page.evaluate(() => {
    const paths = document.querySelectorAll('[data-testid="plan-svg"] :is(.walls, .openings, .objects) path');
    return [...paths].map((p) => p.getAttribute("d")).join("\n");
  });
}

export function sound(faults) {
  assert.deepEqual(faults, []);
}

/** Returns where a thing of the plan lies on the screen. */
export async function middle(page, selector) {
  const box = await page.locator(selector).first().boundingBox();
  assert.ok(box, `${selector} is on the plan`);
  return { x: box.x + box.width / 2, y: box.y + box.height / 2, width: box.width, height: box.height };
}
