// Opens pages in Chromium, works with them as a person would, and says what was seen:
// node look.mjs JOB.json
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const job = JSON.parse(readFileSync(process.argv[2]));
const puppeteer = createRequire(job.modules + "/")("puppeteer-core");
const browser = await puppeteer.launch({
  executablePath: job.browser, headless: true, protocolTimeout: 600000,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
});
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

async function opened({ width = 1280, height = 800, scheme = "light", file }) {
  const page = await browser.newPage();
  const said = [];
  page.on("console", (message) => said.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => said.push(`error: ${error}`));
  page.on("dialog", (dialog) => (said.push(`dialog: ${dialog.message()}`), dialog.dismiss()));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) said.push(`request: ${request.url()}`);
  });
  await page.setViewport({ width, height, hasTouch: width < 600 });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme },
    { name: "prefers-reduced-motion", value: "reduce" }]);
  const began = Date.now();
  await page.goto(pathToFileURL(file), { waitUntil: "load" });
  await page.waitForFunction("window.liftmesh !== undefined", { timeout: 300000 });
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return { page, said, seconds: (Date.now() - began) / 1000 };
}

// How much of the canvas is not background, and of how many colours it is.
const coverage = (page) => page.evaluate(async () => {
  const { view } = window.liftmesh;
  const picture = await createImageBitmap(await view.picture("#ff00ff"));
  const canvas = new OffscreenCanvas(picture.width, picture.height);
  const context = canvas.getContext("2d");
  context.drawImage(picture, 0, 0);
  const { data } = context.getImageData(0, 0, picture.width, picture.height);
  let covered = 0;
  const colours = new Set();
  for (let i = 0; i < data.length; i += 4) {
    if (data[i] === 255 && data[i + 1] === 0 && data[i + 2] === 255) continue;
    ++covered;
    colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
  }
  return { share: covered / (data.length / 4), colours: colours.size };
});

// Frames a second while the view turns.
const rate = (page) => page.evaluate(() => new Promise((done) => {
  const { view } = window.liftmesh;
  const began = performance.now();
  let frames = 0;
  const turn = () => {
    view.look(205 + frames, 38);
    view.drawNow();
    view.renderer.getContext().finish();
    ++frames;
    const seconds = (performance.now() - began) / 1000;
    if (seconds < 2) requestAnimationFrame(turn);
    else done(frames / seconds);
  };
  turn();
}));

// Clicks where rows of the data are drawn, with the mouse: the page has to name these rows.
async function picked(page, rows) {
  const found = [];
  for (const place of rows) {
    const [x, y] = await page.evaluate((each) => {
      const { view } = window.liftmesh;
      view.look(180, 90);
      view.drawNow();
      const { left, top } = view.renderer.domElement.getBoundingClientRect();
      const [x, y] = view.project(each);
      return [x + left, y + top];
    }, place);
    await page.mouse.click(x, y);
    found.push(await page.evaluate(() => window.liftmesh.tools.picked ?? null));
  }
  return found;
}

// Each control by its key, and whether the picture changed.
async function worked(page) {
  const changes = {};
  let before = await page.screenshot({ encoding: "base64" });
  for (const key of ["w", "c", "+", "t", "d", "h", "h", "d", "r", "-"]) {
    await page.keyboard.press(key);
    await pause(120);
    const after = await page.screenshot({ encoding: "base64" });
    changes[key] = changes[key] !== false && after !== before;
    before = after;
  }
  await page.keyboard.press("?");
  changes["?"] = await page.evaluate(() => document.getElementById("help").open);
  await page.keyboard.press("Escape");
  await page.mouse.move(400, 400);
  await page.mouse.down();
  await page.mouse.move(520, 430, { steps: 4 });
  await page.mouse.up();
  await pause(120);
  changes.drag = (await page.screenshot({ encoding: "base64" })) !== before;
  return changes;
}

async function measured(page) {
  await page.keyboard.press("r");
  const { width, height } = await page.evaluate(() => {
    const canvas = document.getElementById("canvas");
    return { width: canvas.clientWidth, height: canvas.clientHeight };
  });
  const across = async (key) => {
    await page.keyboard.press(key);
    await page.mouse.click(width * 0.42, height * 0.5);
    await page.mouse.click(width * 0.58, height * 0.52);
    await pause(100);
  };
  await across("m");
  const distances = await page.evaluate(() => window.liftmesh.tools.measured ?? null);
  await across("p");
  const profile = await page.evaluate(() => {
    const cut = window.liftmesh.tools.profile?.[0];
    const drawer = document.getElementById("drawer");
    return cut && { length: cut.length, pieces: cut.pieces.length, shown: !drawer.hidden };
  });
  return { distances, profile };
}

try {
  const results = [];
  for (const each of job.pages) {
    const { page, said, seconds } = await opened(each);
    const result = { name: each.name, seconds, said, coverage: await coverage(page) };
    if (each.rate) result.rate = await rate(page);
    if (each.rows) result.picked = await picked(page, each.rows);
    if (each.work) Object.assign(result, { worked: await worked(page) }, await measured(page));
    if (each.script) result.script = await page.evaluate(each.script);
    await pause(200);
    await page.screenshot({ path: each.picture });
    results.push(result);
    await page.close();
  }
  writeFileSync(job.result, JSON.stringify(results, null, 1));
} finally {
  await browser.close();
}
