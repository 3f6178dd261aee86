// node page.js FILE WIDTH light|dark: violations that axe finds, and what is wider than the screen, as JSON.
const path = require("path");
const puppeteer = require("puppeteer-core");
(async () => {
  const [file, width, scheme, chromium] = process.argv.slice(2);
  const browser = await puppeteer.launch({ executablePath: chromium, args: ["--no-sandbox"] });
  const page = await browser.newPage();
  const errors = [];
  page.on("pageerror", (e) => errors.push(String(e)));
  await page.setBypassCSP(true); // for axe only: the page itself lets no script in
  await page.setViewport({ width: +width, height: 900 });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
  await page.goto("file://" + path.resolve(file));
  await page.evaluate(async () => { // figures are drawn as they come near
    for (let y = 0; y < document.body.scrollHeight; y += 500) { scrollTo(0, y); await new Promise((r) => setTimeout(r, 60)); }
    scrollTo(0, 0); await new Promise((r) => setTimeout(r, 300));
  });
  const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  await page.addScriptTag({ path: require.resolve("axe-core") });
  const found = await page.evaluate(() => axe.run(document, { resultTypes: ["violations"], rules: { "target-size": { enabled: true } } }));
  await browser.close();
  const version = require("axe-core/package.json").version;
  const violations = found.violations.map((v) => `${v.id} (${v.nodes.length})`);
  console.log(JSON.stringify({ version, violations, errors, wider }));
})();
