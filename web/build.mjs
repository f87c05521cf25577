// Bundles the page into dist/{index.html,app.js,app.css}: three files, and nothing else is served.
import {build} from 'esbuild';
import {copyFile, mkdir, stat} from 'node:fs/promises';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = join(here, 'dist');
const kLargest = 1_000_000;  // of the three files together [bytes]

await mkdir(out, {recursive: true});
await build({
  entryPoints: {app: join(here, 'src/main.ts')},
  outdir: out,
  bundle: true,
  minify: true,
  format: 'esm',
  target: 'es2022',
  legalComments: 'eof',
  logLevel: 'warning',
});
await copyFile(join(here, 'src/index.html'), join(out, 'index.html'));

// The script of reports, a file for itself: `predictor report` puts it into its pages.
await build({
  entryPoints: {report: join(here, 'report/report.ts')},
  outdir: out,
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  logLevel: 'warning',
});

let total = 0;
for (const name of ['index.html', 'app.js', 'app.css']) {
  const {size} = await stat(join(out, name));
  console.log(`${name.padEnd(11)} ${(size / 1000).toFixed(1).padStart(7)} kB`);
  total += size;
}
console.log(`together    ${(total / 1000).toFixed(1).padStart(7)} kB`);
if (total > kLargest) throw new Error(`the page is larger than ${kLargest / 1000} kB`);
