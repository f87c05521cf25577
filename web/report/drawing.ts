// Draws a laid-out plot as an SVG file.
import {CustomChart, LineChart, ScatterChart} from 'echarts/charts';
import {
  DataZoomInsideComponent, GraphicComponent, GridComponent, LegendPlainComponent, MarkAreaComponent, MarkLineComponent,
  TitleComponent, ToolboxComponent, TooltipComponent,
} from 'echarts/components';
import {ECharts, init, use} from 'echarts/core';
import {SVGRenderer} from 'echarts/renderers';
import {Colors, Layout, makeOption} from './option';

use([
  CustomChart, DataZoomInsideComponent, GraphicComponent, GridComponent, LegendPlainComponent, LineChart,
  MarkAreaComponent, MarkLineComponent, ScatterChart, SVGRenderer, TitleComponent, ToolboxComponent, TooltipComponent,
]);

export function make(element: HTMLElement | null, width: number, height: number): ECharts {
  return init(element, null, {renderer: 'svg', ssr: element === null, width, height});
}

// Draws the plot as a separate picture with its own background.
export function draw(layout: Layout, color: Colors): string {
  const drawing = make(null, layout.view.width, layout.height);
  drawing.setOption({...makeOption(layout, color), backgroundColor: color('surface')});
  const svg = drawing.renderToSVGString();
  drawing.dispose();
  return svg.replace(/ ecmeta_\w+="[^"]*"/g, '');  // with which a server's page could make it respond
}
