// Bundles the page into dist/{index.html,app.js,app.css}. The server provides only these three
// files.
import {build} from 'esbuild';
import {copyFile, mkdir, readFile, stat} from 'node:fs/promises';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = join(here, 'dist');
const kLargest = 1_000_000;  // of the three files together, and of the reports' script [bytes]

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

// The script of reports is a file of its own, which goes into every page with plots. So do the
// licences of the library that draws them.
const licences = await Promise.all(['echarts/NOTICE', 'zrender/LICENSE', 'echarts/licenses/LICENSE-d3'].map(
    (file) => readFile(join(here, 'node_modules', file), 'utf8')));
await build({
  entryPoints: {report: join(here, 'report/report.ts')},
  outdir: out,
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  logLevel: 'warning',
  banner: {js: `/*!\nApache ECharts: Apache License 2.0, https://www.apache.org/licenses/LICENSE-2.0\n${licences.join('\n')}*/`},
});

let total = 0;
for (const name of ['index.html', 'app.js', 'app.css']) {
  const {size} = await stat(join(out, name));
  console.log(`${name.padEnd(11)} ${(size / 1000).toFixed(1).padStart(7)} kB`);
  total += size;
}
console.log(`together    ${(total / 1000).toFixed(1).padStart(7)} kB`);
const {size: report} = await stat(join(out, 'report.js'));
console.log(`report.js   ${(report / 1000).toFixed(1).padStart(7)} kB`);
if (Math.max(total, report) > kLargest) throw new Error(`a page is larger than ${kLargest / 1000} kB`);
