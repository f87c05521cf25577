// The page: connects, plays the states into scene, panel and plots, and takes what the person does.
import './app.css';
import {App} from './app';
import {takeCodeFromAddress} from './connection';
import {inspection} from './inspect';

const app = new App(document.getElementById('app')!);
window.predictor = inspection(app);
app.start(takeCodeFromAddress());
