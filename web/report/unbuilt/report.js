// Replaces the report script if it was not built.
for (const drawing of document.querySelectorAll('.drawing')) {
  drawing.textContent = 'No plot: this program was built without the script that draws plots (./dev setup bundles it).';
}
