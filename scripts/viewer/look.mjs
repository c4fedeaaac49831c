// Opens the page in Chromium, and takes a screenshot of each view: node look.mjs JOB.json
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";

const job = JSON.parse(readFileSync(process.argv[2]));
const puppeteer = createRequire(job.modules + "/")("puppeteer-core");
const browser = await puppeteer.launch({
  executablePath: job.browser, headless: true, protocolTimeout: 600000,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
});
try {
  const page = await browser.newPage();
  await page.setViewport({ width: job.width, height: job.height });
  const said = [];
  page.on("console", (message) => said.push(message.text()));
  page.on("pageerror", (error) => said.push(String(error)));
  page.on("requestfailed", (request) => said.push("failed: " + request.url()));
  page.on("request", (request) => {
    if (!request.url().startsWith(job.origin) && !/^(data|blob):/.test(request.url()))
      said.push("outside: " + request.url());
  });
  await page.goto(job.url, { waitUntil: "load" });
  await page.evaluate(() => begin());
  const views = [];
  for (const view of job.views) {
    const tiles = await page.evaluate((each) => look(each), view);
    await page.screenshot({ path: view.picture });
    views.push(tiles);
  }
  writeFileSync(job.result, JSON.stringify({ views, said }));
} finally {
  await browser.close();
}
