const place = document.getElementById("stage");
try {
  window.view = await mount(place, JSON.parse(document.getElementById("scene").textContent));
} catch (fault) {
  place.textContent = `This browser cannot show the view (${fault.message}).`;
}
