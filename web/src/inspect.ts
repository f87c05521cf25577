// Gives tests and developers read-only access through `window.predictor`. The functions of this
// module do not change the page.
import {Vector3} from 'three';
import {App} from './app';
import {kSteps, Step} from './latency';
import {Pose, Side, State, Vec3} from './protocol';
import {PlateName} from './vr/board';

// What the scene and the headset show.
function inspectionOfScene(app: App) {
  const {stage, immersive} = app;
  return {
    ghostsReady: () => stage.ghostsLoaded,
    firstRenderMs: () => stage.firstRenderMs,
    // Returns the drawn pose in W of a link of the cobot, of 'object', of 'movable:NAME', of 'left:LINK'
    // (an arm), or of 'left:handle'.
    linkPose: (name: string): Pose | null => stage.linkPose(name),
    // Returns the bounding box in W of the visuals of a link of the cobot, of 'object', or of
    // 'movable:NAME' [m].
    meshBox: (name: string) => stage.meshBox(name),
    // Bounding boxes in W of the fixtures that are present [m].
    fixtureBoxes: () => stage.fixtureBoxes,
    // Texts and places in W of the labels above keep-out volumes [m].
    fixtureLabels: () => stage.fixtureLabels,
    placeholders: () => stage.placeholders,
    arrowColour: (side: Side, of: 'force' | 'torque' = 'force') => stage.arrows[side][of].level,
    arrowVisible: (side: Side, of: 'force' | 'torque' = 'force') =>
      stage.arrows[side].group.visible && stage.arrows[side][of].group.visible,
    // The points and colours of the body as drawn.
    body: () => ({
      points: app.person.sample(performance.now()), colors: {...stage.body.colors},
      visible: stage.body.group.visible,
      mirror: stage.mirror.group.visible && stage.mirror.body.group.visible,
    }),
    view: () => stage.camera.view,
    cameraPosition: (): Vec3 => stage.camera.camera.position.toArray(),
    project: (p: Vec3) => stage.project(p),
    // The radius of a handle's ring on the page [px].
    ringOnScreen: (side: Side) => stage.ringOnScreen(side),
    immersive: () => ({
      active: immersive.session !== null, ...immersive.counters, tones: immersive.tone.played,
      board: immersive.board.content, registration: immersive.registrar.registration,
      drift: immersive.registrar.drift,
    }),
    // The point with which a controller or hand touches, in the headset's space (three.js's axes)
    // [m].
    tip: (side: Side): Vec3 | null => immersive.tips[side],
    // Converts a point in W, or a plate of the board, to the headset's space (three.js's axes) [m].
    inHeadsetSpace: (p: Vec3): Vec3 => stage.world.localToWorld(new Vector3(...p)).toArray(),
    platePosition: (name: PlateName): Vec3 =>
      immersive.board.plateGroup(name).getWorldPosition(new Vector3()).toArray(),
    shaders: () => stage.renderer.info.programs?.length ?? 0,
    drawCalls: () => stage.renderer.info.render.calls,
    triangles: () => stage.renderer.info.render.triangles,
  };
}

// The state of the connection, the run and the page around the scene.
function inspectionOfPage(app: App) {
  const {connection, stage, panel, overlay, plots, hands, latency} = app;
  return {
    phase: () => connection.phase,
    client: () => connection.client,
    role: () => connection.role,
    leases: () => ({...connection.leases}),
    counters: () => ({
      ...connection.counters, frames: stage.frames, points: plots.points,
      trail: stage.guidance.trailLength, trailMarks: stage.guidance.trailMarks,
    }),
    ready: () => stage.settled && app.shown !== null,
    // The newest state as received, and the drawn (interpolated) state.
    state: (): State | null => app.player.latest,
    shown: (): State | null => app.shown,
    // The newest state of the person as received.
    person: () => app.person.latest,
    personCount: () => app.person.count,
    scene: () => app.spec?.name ?? null,
    stateText: () => panel.stateText,
    stopText: () => panel.stopText,
    instruction: () => overlay.instructionText,
    guidanceError: () => (app.shown ? stage.guidance.error(app.shown.object.p) : NaN),
    handTargets: () => ({...hands.targets}),
    hovered: () => app.mouse.hovered,
    plotRange: () => plots.shownRange(),
    plotsPaused: () => plots.paused,
    plotTable: () => plots.table(),
    latency: () => Object.fromEntries(
        kSteps.map((step: Step) => [step, latency.figures(step)])),
    clock: () => ({offsetMs: connection.clock.offsetMs, roundTripMs: connection.clock.roundTripMs}),
    theme: () => app.theme.theme,
  };
}

export function inspection(app: App) {
  return {...inspectionOfPage(app), ...inspectionOfScene(app)};
}

declare global {
  interface Window {
    predictor: ReturnType<typeof inspection>;
  }
}
