#include "calibration/app/clicks_page.h"

#include <cstdint>
#include <nlohmann/json.hpp>

#include "common/image_codec/image_codec.h"

namespace vismem {
namespace {

constexpr int kJpegQuality = 95;

constexpr const char* kHead = R"html(<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Colours by clicks</title>
<style>
  body { font: 15px/1.5 system-ui, sans-serif; margin: 0 1.5rem 2rem; color: #26282c; background: #fff; }
  header { position: sticky; top: 0; background: #fff; padding: .6rem 0; border-bottom: 1px solid #ccd; z-index: 2; }
  h1 { font-size: 1.15rem; margin: 0 0 .3rem; }
  input, button { font: inherit; padding: .3rem .6rem; min-height: 2.2rem; }
  #note { color: #b3261e; min-height: 1.5em; }
  main { display: flex; flex-wrap: wrap; gap: 1rem; margin-top: 1rem; }
  figure { margin: 0; position: relative; }
  figure img { display: block; max-width: 100%; cursor: crosshair; }
  figure i { position: absolute; width: 9px; height: 9px; margin: -6px; border: 2px solid #fff; border-radius: 50%;
    outline: 1px solid #000; pointer-events: none; }
  #clicks { list-style: none; padding: 0; display: flex; flex-wrap: wrap; gap: .4rem; margin: .4rem 0 0; }
  #clicks b { display: inline-block; width: 1em; height: 1em; vertical-align: -.15em; border: 1px solid #000; margin: 0 .3em; }
</style>
<header>
  <h1>Colours by clicks</h1>
  Type what a surface is, such as floor, wall or door, and click on it in an image. <code>ignored</code> is a pattern of the
  floor whose edges are not to be remembered. Several clicks of one name show the class in several lights.
  <div>
    <label>This is <input id="name" list="names" size="16" autofocus></label> <datalist id="names"></datalist>
    <button id="save">save as a file</button> <span id="note" role="status"></span>
  </div>
  <ul id="clicks"></ul>
  <div>Then: <code>scripts/own_robot NAME colours --clicks FILE</code>, or <code>learn_palette ... --clicks FILE</code></div>
</header>
<main></main>
<script type="application/json" id="data">)html";

constexpr const char* kTail = R"html(</script>
<script>
"use strict";
const {images, classes, clicks} = JSON.parse(document.getElementById("data").textContent);
const main = document.querySelector("main"), list = document.getElementById("clicks");
const field = document.getElementById("name"), note = document.getElementById("note");
const pictures = new Map();
const element = (kind, properties = {}) => Object.assign(document.createElement(kind), properties);

function colourAt(picture, u, v) {
  const canvas = element("canvas", {width: 1, height: 1}), context = canvas.getContext("2d");
  context.drawImage(picture, -u, -v);
  return `rgb(${context.getImageData(0, 0, 1, 1).data.slice(0, 3)})`;
}

function draw() {
  document.querySelectorAll("figure i").forEach(dot => dot.remove());
  list.replaceChildren();
  clicks.forEach((click, index) => {
    const [name, image, u, v] = click.split(/\s+/), picture = pictures.get(image);
    const item = element("li"), swatch = element("b");
    if (picture) {
      swatch.style.background = colourAt(picture, u, v);
      const dot = element("i", {title: name});
      dot.style.left = `${100 * (+u + .5) / picture.naturalWidth}%`;
      dot.style.top = `${100 * (+v + .5) / picture.naturalHeight}%`;
      picture.parentElement.append(dot);
    }
    const remove = element("button", {textContent: "x", title: "take this click back"});
    remove.onclick = () => { clicks.splice(index, 1); draw(); };
    item.append(swatch, click, " ", remove);
    list.append(item);
  });
  const names = new Set([...classes, ...clicks.map(click => click.split(/\s+/)[0]), "floor", "wall", "door", "ignored"]);
  document.getElementById("names").replaceChildren(...[...names].map(value => element("option", {value})));
}

function clicked(event, image) {
  const picture = event.target, name = field.value.trim();
  note.textContent = /^[A-Za-z]\w*$/.test(name) ? "" : "Type a name first: letters, digits and _, and it begins with a letter.";
  if (note.textContent) return field.focus();
  const at = (offset, shown, pixels) => Math.min(pixels - 1, Math.max(0, Math.floor(offset * pixels / shown)));
  const u = at(event.offsetX, picture.clientWidth, picture.naturalWidth);
  clicks.push(`${name} ${image} ${u} ${at(event.offsetY, picture.clientHeight, picture.naturalHeight)}`);
  draw();
}

document.getElementById("save").onclick = () => {
  if (clicks.length === 0) return void (note.textContent = "Nothing was clicked yet.");
  const href = URL.createObjectURL(new Blob([clicks.join("\n") + "\n"], {type: "text/plain"}));
  element("a", {href, download: "place.clicks"}).click();
};

Promise.all(images.map(({name, jpeg}) => {
  const figure = element("figure"), picture = element("img", {alt: name, src: `data:image/jpeg;base64,${jpeg}`});
  picture.onclick = event => clicked(event, name);
  pictures.set(name, picture);
  figure.append(picture, element("figcaption", {textContent: name}));
  main.append(figure);
  return picture.decode();
})).then(draw);
</script>
</html>
)html";

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) -> unsigned { return i + k < bytes.size() ? bytes[i + k] : 0; };
    const unsigned bits = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (const int shift : {18, 12, 6, 0}) text += kDigits[bits >> shift & 63];
  }
  for (std::size_t pad = (3 - bytes.size() % 3) % 3; pad > 0; --pad) text[text.size() - pad] = '=';
  return text;
}

}  // namespace

std::string clicksPage(const std::vector<ClickableImage>& images, const std::vector<std::string>& classes,
                       const std::vector<std::string>& clicks) {
  nlohmann::json data{{"images", nlohmann::json::array()}, {"classes", classes}, {"clicks", clicks}};
  for (const ClickableImage& one : images)
    data["images"].push_back({{"name", one.name}, {"jpeg", base64(encodeJpeg(one.image, kJpegQuality))}});
  std::string text = data.dump();
  // A name must not end the element that holds it.
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
    text.insert(at + 1, "\\");
  return kHead + text + kTail;
}

}  // namespace vismem
