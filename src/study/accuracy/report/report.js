"use strict";
const wipe = document.getElementById("wipe");
const over = document.getElementById("wipe-over");
const choice = document.getElementById("wipe-choice");
const at = document.getElementById("wipe-at");
function choose() {
  over.src = document.querySelector(`#stock img[data-name="${choice.value}"]`).src;
  over.alt = choice.value;
}
function move() {
  wipe.style.setProperty("--at", `${at.value}%`);
}
choice.addEventListener("change", choose);
at.addEventListener("input", move);
wipe.addEventListener("pointermove", (event) => {
  if (event.buttons || event.pointerType === "mouse") {
    const box = wipe.getBoundingClientRect();
    at.value = (100 * (event.clientX - box.left)) / box.width;
    move();
  }
});
choose();
move();
