// Saves files by offering them as downloads. No data leaves the browser.

export function save(name: string, content: Blob) {
  const link = document.createElement('a');
  const url = URL.createObjectURL(content);
  const now = new Date().toISOString().slice(0, 19).replaceAll(':', '-');
  link.href = url;
  link.download = `predictor-${now}-${name}`;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
