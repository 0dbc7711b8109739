#include "cli/pair_page.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "cli/html.h"
#include "figures/markup.h"

namespace candela::cli {

namespace {

using figures::escaped;

/// Without a script the pictures stand side by side. What is transparent shows squares.
constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 1em; }
h1, h2 { line-height: 1.2; overflow-wrap: anywhere; font-size: 1.4em; }
h2 { font-size: 1.1em; margin-bottom: 0; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; margin: .3em 0 .6em; }
nav { display: none; position: sticky; top: 0; z-index: 1; padding: .5em 0; background: Canvas; gap: .5em; flex-wrap: wrap; }
.scripted nav { display: flex; }
button { font: inherit; padding: .35em .9em; }
button[aria-pressed=true] { outline: 2px solid currentColor; }
.beyond h2 { color: #d0202f; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(15em, 100%), 1fr)); gap: .5em; --at: 50%; }
figure { margin: 0; }
img { display: block; width: 100%; background: repeating-conic-gradient(#8a8a8a 0 25%, #a2a2a2 0 50%) 0 0 / 16px 16px; }
.small img { image-rendering: pixelated; }
.at { display: none; width: 100%; margin: .5em 0; }
.over .pictures { grid-template-columns: 1fr; max-width: min(100%, 90vh * var(--aspect)); position: relative; }
.over .first, .over .second { grid-area: 1 / 1; }
.over .error { display: none; }
.over figcaption { position: absolute; top: .5em; padding: 0 .5em; background: Canvas; }
.over .first figcaption { left: .5em; }
.over .second figcaption { right: .5em; }
.slider .pictures { touch-action: pan-y; cursor: ew-resize; user-select: none; }
.slider .second { clip-path: inset(0 0 0 var(--at)); }
.slider .pictures::after { content: ""; position: absolute; inset: 0 auto 0 var(--at); width: 2px; background: #fff; mix-blend-mode: difference; }
.slider .at { display: block; max-width: min(100%, 90vh * var(--aspect)); }
.flip .pictures { cursor: pointer; }
.flip.shows-first .second, .flip:not(.shows-first) .first { visibility: hidden; }
.map .pictures { grid-template-columns: 1fr; max-width: min(100%, 90vh * var(--aspect)); }
.map .first, .map .second { display: none; }
)css";

constexpr const char* kScript = R"js(
const root = document.documentElement, buttons = [...document.querySelectorAll("nav button")];
let timer = 0;
const flip = () => root.classList.toggle("shows-first");
const run = on => { clearInterval(timer); timer = on ? setInterval(flip, 800) : 0; };
const choose = mode => {
  root.className = "scripted " + mode + (mode == "slider" || mode == "flip" ? " over" : "");
  buttons.forEach(b => b.setAttribute("aria-pressed", b.value == mode));
  run(mode == "flip" && !matchMedia("(prefers-reduced-motion: reduce)").matches);
};
buttons.forEach(b => b.onclick = () => choose(b.value));
document.querySelectorAll(".pictures").forEach(p => {
  const range = p.nextElementSibling;
  const set = share => { p.style.setProperty("--at", share + "%"); range.value = share; };
  const follow = e => {
    const box = p.getBoundingClientRect();
    if (root.classList.contains("slider")) set(Math.min(100, Math.max(0, 100 * (e.clientX - box.left) / box.width)));
  };
  range.oninput = () => set(range.value);
  p.onpointermove = e => { if (e.buttons || e.pointerType == "mouse") follow(e); };
  p.onpointerdown = follow;
  p.onclick = () => { if (root.classList.contains("flip")) { run(false); flip(); } };
  p.querySelectorAll("img").forEach(i => i.draggable = false);
});
addEventListener("keydown", e => {
  const mode = { 1: "side", 2: "slider", 3: "flip", 4: "map" }[e.key];
  if (mode) choose(mode);
});
choose("side");
)js";

std::string figure(const DisplayImage& image, const char* kind, const std::string& what) {
  return fmt::format("<figure class=\"{}\">{}<figcaption>{}</figcaption></figure>\n", kind, image_element(image, what),
                     what);
}

}  // namespace

std::string pair_pictures(const PictureDifference& d, const std::string& first, const std::string& second) {
  constexpr int kSmall = 256;  // pixels; below, they are shown as squares
  std::string html = fmt::format("<div class=\"pictures{}\" style=\"--aspect: {:.6g}\">\n",
                                 d.size.x < kSmall ? " small" : "", static_cast<double>(d.size.x) / d.size.y);
  html += figure(d.first, "first", first) + figure(d.second, "second", second);
  html += figure(error_map(d.error), "error", "error (FLIP: black 0, pale yellow 1)");
  return html +
         fmt::format("</div>\n<input class=\"at\" type=\"range\" aria-label=\"where the {} begins, of the width\">\n",
                     escaped(second));
}

std::string pair_page(const std::string& title, const std::string& heading, const std::string& body) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
      "<style>{}</style></head><body>\n<h1>{}</h1>\n",
      escaped(title), kStyle, escaped(heading));
  std::string nav = "<nav>";
  for (const auto& [mode, text] :
       {std::pair{"side", "Side by side"}, {"slider", "Slider"}, {"flip", "Flip"}, {"map", "Error"}}) {
    nav += fmt::format("<button value=\"{}\">{}</button>", mode, text);
  }
  html += nav + "</nav>\n" + body;
  return html + fmt::format("<script>{}</script>\n</body></html>\n", kScript);
}

}  // namespace candela::cli
