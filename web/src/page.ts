// The page around the element: files, settings, findings. Everything it does is done by the element's public interface.

import { CandelaError, type Finding, type Info } from "./viewer.js";

function part<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`no element #${id}`);
  return found as T;
}

const viewer = part<HTMLElementTagNameMap["candela-viewer"]>("viewer");
const status = part("status");
const environment = part<HTMLSelectElement>("environment");
const exposure = part<HTMLInputElement>("exposure");
const stops = part<HTMLOutputElement>("stops");
const tonemap = part<HTMLSelectElement>("tonemap");
const variant = part<HTMLSelectElement>("variant");
const animation = part<HTMLSelectElement>("animation");
const play = part<HTMLButtonElement>("play");
const buttons = ["reset", "screenshot", "bake", "check"].map((id) => part<HTMLButtonElement>(id));

let name = "model";

function say(text: string): void {
  status.textContent = text;
}

/** Does what takes a while, says what it is, and shows a failure in one line. */
async function during(what: string, work: () => Promise<string>): Promise<void> {
  say(`${what}…`);
  try {
    say(await work());
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") return;
    say(error instanceof Error ? error.message : String(error));
  }
}

function detailOf<Detail>(event: Event): Detail {
  return (event as CustomEvent<Detail>).detail;
}

function save(data: Blob, as: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(data);
  link.download = as;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

function option(value: string, text: string): HTMLOptionElement {
  const made = document.createElement("option");
  made.value = value;
  made.textContent = text;
  return made;
}

// ----- what the file has

function showFacts(info: Info): void {
  const list = part("facts").querySelector("dl");
  if (list === null) return;
  const metres = info.size.map((length) => Number(length.toPrecision(3))).join(" × ");
  const rows: [string, string][] = [
    ["Triangles", info.triangles.toLocaleString("en")],
    ["Materials", String(info.materials)],
    ["Images", String(info.images)],
    ["Lights", String(info.lights)],
    ["Metres", metres],
    ["Made by", info.generator],
    ["Extensions", info.extensions.join(", ")],
    ["Not supported", info.ignored.join(", ")],
  ];
  list.replaceChildren(
    ...rows
      .filter(([, value]) => value !== "")
      .flatMap(([key, value]) => {
        const term = document.createElement("dt");
        const text = document.createElement("dd");
        term.textContent = key;
        text.textContent = value;
        return [term, text];
      }),
  );
  part("facts").hidden = false;
}

function showChoices(info: Info): void {
  variant.replaceChildren(option("", "as in the file"), ...info.variants.map((one) => option(one, one)));
  variant.value = viewer.getAttribute("variant") ?? "";
  part("variant-row").hidden = info.variants.length === 0;
  animation.replaceChildren(
    ...info.animations.map((one, i) => option(String(i), `${one.name || `animation ${i}`}, ${one.duration.toFixed(1)} s`)),
    option("all", "all together"),
  );
  part("animation-row").hidden = info.animations.length === 0;
  play.hidden = info.animations.length === 0;
}

function showPlaying(): void {
  play.textContent = viewer.isPlaying ? "Pause" : "Play";
  play.setAttribute("aria-pressed", String(viewer.isPlaying));
}

viewer.addEventListener("load", (event) => {
  const { info, url } = detailOf<{ info: Info; url: string }>(event);
  name = (url.split(/[/\\]/).pop() ?? url).replace(/\.[^.]*$/, "") || "model";
  for (const button of buttons) button.disabled = false;
  part("findings").hidden = true;
  showFacts(info);
  showChoices(info);
  showPlaying();
  say(`${url}: ${info.triangles.toLocaleString("en")} triangles`);
});
viewer.addEventListener("progress", (event) => {
  const { totalProgress, what } = detailOf<{ totalProgress: number; what: string }>(event);
  if (totalProgress < 1) say(`${what}, ${Math.round(100 * totalProgress)} %`);
});
viewer.addEventListener("error", (event) => {
  const { message, where } = detailOf<{ message: string; where: string }>(event);
  say(where === "" ? message : `${where}: ${message}`);
});

// ----- files

async function openModel(files: File[]): Promise<void> {
  if (files.length === 0) return;
  viewer.removeAttribute("variant");
  viewer.removeAttribute("animation");
  const only = files[0];
  await during(`Opening ${only?.name ?? ""}`, async () => {
    const info = await viewer.load(files.length === 1 && only !== undefined ? only : files);
    return `${only?.name ?? ""}: ${info.triangles.toLocaleString("en")} triangles`;
  });
}

async function openLight(file: File | undefined): Promise<void> {
  if (file === undefined) return;
  await during(`Baking ${file.name}`, async () => {
    await viewer.setEnvironment(file);
    environment.querySelector("option[data-own]")?.remove();
    const own = option("\u0000own", file.name);
    own.dataset["own"] = "";
    own.disabled = true;
    environment.append(own);
    environment.value = own.value;
    return `lit by ${file.name}`;
  });
}

/** What a dropped file is for; a .ktx2 alone is a light. */
function isLight(file: File): boolean {
  return /\.(hdr|exr|ktx|dds)$/i.test(file.name);
}

async function openAll(files: File[]): Promise<void> {
  const lights = files.filter(isLight);
  const models = files.filter((file) => !isLight(file));
  await openLight(lights[0]);
  await openModel(models);
}

part<HTMLInputElement>("model").addEventListener("change", (event) => {
  const input = event.target as HTMLInputElement;
  void openModel([...(input.files ?? [])]).finally(() => (input.value = ""));
});
part<HTMLInputElement>("light").addEventListener("change", (event) => {
  const input = event.target as HTMLInputElement;
  void openLight(input.files?.[0]).finally(() => (input.value = ""));
});
document.addEventListener("dragover", (event) => {
  event.preventDefault();
  document.body.classList.add("dropping");
});
document.addEventListener("dragleave", (event) => {
  if (event.relatedTarget === null) document.body.classList.remove("dropping");
});
document.addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  void openAll([...(event.dataTransfer?.files ?? [])]);
});

// ----- settings

environment.addEventListener("change", () => {
  viewer.setAttribute("env", environment.value);
  void during("Baking the light", async () => {
    await viewer.setEnvironment(environment.value);
    return environment.value === "" ? "lit as the model asks" : `lit by ${environment.value}`;
  });
});
exposure.addEventListener("input", () => {
  const value = Number(exposure.value);
  stops.textContent = value === 0 ? "auto" : `${value > 0 ? "+" : ""}${value}`;
  if (value === 0) viewer.removeAttribute("exposure");
  else viewer.setAttribute("exposure", String(2 ** value));
});
tonemap.addEventListener("change", () => viewer.setAttribute("tonemap", tonemap.value));
variant.addEventListener("change", () => viewer.setAttribute("variant", variant.value));
animation.addEventListener("change", () => {
  viewer.setAttribute("animation", animation.value);
  setTimeout(showPlaying, 0);
});
play.addEventListener("click", () => {
  if (viewer.isPlaying) viewer.pause();
  else viewer.play();
  showPlaying();
});
part("reset").addEventListener("click", () => viewer.resetCamera());

part("screenshot").addEventListener("click", () => {
  void during("Drawing", async () => {
    const picture = await viewer.render();
    const canvas = document.createElement("canvas");
    canvas.width = picture.width;
    canvas.height = picture.height;
    canvas.getContext("bitmaprenderer")?.transferFromImageBitmap(picture);
    const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
    if (blob === null) throw new CandelaError({ message: "the browser cannot encode the picture", where: "" });
    save(blob, `${name}.png`);
    return `saved ${name}.png`;
  });
});

part("bake").addEventListener("click", () => {
  void during("Baking the light", async () => {
    const files = await viewer.bake();
    for (const file of files) save(file, file.name);
    return `saved ${files.map((file) => file.name).join(", ")}`;
  });
});

// ----- findings

function findingItem(finding: Finding): HTMLLIElement {
  const item = document.createElement("li");
  item.className = finding.severity;
  const code = document.createElement("code");
  code.textContent = `${finding.severity}: ${finding.code}`;
  const about = [finding.material, finding.texture, finding.subject].filter((one) => one).join(", ");
  const text = document.createElement("div");
  text.textContent = about === "" ? finding.message : `${about}: ${finding.message}`;
  item.append(code, text);
  if (finding.fix) {
    const fix = document.createElement("small");
    fix.textContent = finding.fix;
    item.append(fix);
  }
  return item;
}

part("check").addEventListener("click", () => {
  void during("Checking", async () => {
    const { findings } = await viewer.check();
    part("findings").querySelector("ul")?.replaceChildren(...findings.map(findingItem));
    part("findings").hidden = false;
    return findings.length === 0 ? "nothing is implausible" : `${findings.length} finding${findings.length === 1 ? "" : "s"}`;
  });
});

// ----- a link may name a model and its light: ?src=…&env=…

const asked = new URLSearchParams(location.search);
for (const attribute of ["env", "src", "variant", "animation", "exposure", "tonemap", "camera-orbit"]) {
  const value = asked.get(attribute);
  if (value !== null) viewer.setAttribute(attribute, value);
}
if (!asked.has("src")) viewer.setAttribute("src", "demo:materials");
