// Shows a running PREDICTOR in Unity, over Unity's ROS-TCP-Connector 0.7.0 (docs/how-to/unity.md).
// PREDICTOR's own tests do NOT compile or run this file, because they have no Unity editor.
//
// Put this script on an empty GameObject, assign the robot that URDF-Importer made from the package
// of `predictor export scene`, and press Play. The messages determine everything. The script
// switches off the bodies' own physics (drives, gravity, collisions), since the simulation runs in
// PREDICTOR.
using System.Collections.Generic;
using RosMessageTypes.Geometry;
using RosMessageTypes.Sensor;
using RosMessageTypes.Std;
using RosMessageTypes.Visualization;
using Unity.Robotics.ROSTCPConnector;
using Unity.Robotics.ROSTCPConnector.ROSGeometry;
using UnityEngine;

public class PredictorScene : MonoBehaviour
{
    [Tooltip("Root of the robot that URDF-Importer created.")]
    public GameObject robot;
    [Tooltip("The carried object, moved to its pose in the world; if empty, the robot's link \"object\".")]
    public Transform carriedObject;
    [Tooltip("Shown to the operator: RUN, HELD force left 30.1 30, ...")]
    public TextMesh stateText;
    [Tooltip("Key that stops the run while connected.")]
    public KeyCode stopKey = KeyCode.Space;
    public Material lineMaterial;

    // The state arrives up to 60 times a second. After this time without it, the picture no longer
    // shows the run.
    const float longestSilence = 0.5f;  // [s]
    const string connectionLost = "CONNECTION LOST: use the robot's emergency stop";

    ROSConnection ros;
    ArticulationBody objectBody;
    float lastState;  // Time.realtimeSinceStartup [s]; 0: none yet
    GUIStyle warning;
    readonly Dictionary<string, ArticulationBody> joints = new Dictionary<string, ArticulationBody>();
    readonly Dictionary<string, LineRenderer> lines = new Dictionary<string, LineRenderer>();

    // Runs before any Start. Otherwise URDF-Importer's own controller would move the joints with
    // the arrow keys.
    void Awake()
    {
        var controller = robot.GetComponent<Unity.Robotics.UrdfImporter.Control.Controller>();
        if (controller != null) controller.enabled = false;
    }

    void Start()
    {
        foreach (var body in robot.GetComponentsInChildren<ArticulationBody>())
        {
            if (body.isRoot) body.immovable = true;
            if (carriedObject == null && body.name == "object") carriedObject = body.transform;
            body.useGravity = false;
            body.jointFriction = body.angularDamping = body.linearDamping = 0;
            var drive = body.xDrive;
            drive.stiffness = drive.damping = drive.forceLimit = 0;
            body.xDrive = drive;
            var joint = body.GetComponent<Unity.Robotics.UrdfImporter.UrdfJoint>();
            if (joint != null) joints[joint.jointName] = body;
        }
        foreach (var collider in robot.GetComponentsInChildren<Collider>()) collider.enabled = false;
        DetachObject();

        ros = ROSConnection.GetOrCreateInstance();
        ros.RegisterPublisher<BoolMsg>("/predictor/stop");
        ros.Subscribe<JointStateMsg>("/predictor/joint_states", OnJoints);
        ros.Subscribe<PoseStampedMsg>("/predictor/object/pose", OnObject);
        ros.Subscribe<MarkerMsg>("/predictor/markers", OnMarker);
        ros.Subscribe<StringMsg>("/predictor/state", OnState);
    }

    // The joints determine the place of a link that is attached to others. A separate link can be
    // placed.
    void DetachObject()
    {
        if (carriedObject == null) return;
        objectBody = carriedObject.GetComponent<ArticulationBody>();
        if (objectBody == null) return;
        carriedObject.SetParent(null, true);
        objectBody.immovable = true;
    }

    void Update()
    {
        if (Input.GetKeyDown(stopKey)) ros.Publish("/predictor/stop", new BoolMsg(true));
        if (Lost && stateText != null) stateText.text = connectionLost;
    }

    bool Lost => Time.realtimeSinceStartup - lastState > longestSilence;

    // Shows the message on the screen, even if the scene has no text.
    void OnGUI()
    {
        if (!Lost) return;
        if (warning == null)
            warning = new GUIStyle(GUI.skin.box) { fontSize = 32, fontStyle = FontStyle.Bold, wordWrap = true };
        GUI.backgroundColor = Color.red;
        GUI.Box(new Rect(0, 0, Screen.width, 100), connectionLost, warning);
    }

    // The script sets the angles and does not drive the joints to them.
    void OnJoints(JointStateMsg message)
    {
        for (int i = 0; i < message.name.Length; i++)
        {
            if (!joints.TryGetValue(message.name[i], out var body)) continue;
            body.jointPosition = new ArticulationReducedSpace((float)message.position[i]);
            body.jointVelocity = new ArticulationReducedSpace(0f);
        }
    }

    void OnObject(PoseStampedMsg message)
    {
        if (carriedObject == null) return;
        Vector3 position = message.pose.position.From<FLU>();
        Quaternion rotation = message.pose.orientation.From<FLU>();
        if (objectBody != null) objectBody.TeleportRoot(position, rotation);
        else carriedObject.SetPositionAndRotation(position, rotation);
    }

    // Draws arrows of forces and torques, and the path to follow, as lines in the colour of the
    // message.
    void OnMarker(MarkerMsg message)
    {
        string key = message.ns + message.id;
        if (!lines.TryGetValue(key, out var line))
        {
            line = new GameObject("predictor " + key).AddComponent<LineRenderer>();
            line.material = lineMaterial;
            line.useWorldSpace = true;
            lines[key] = line;
        }
        line.startWidth = (float)message.scale.x;
        line.endWidth = message.type == MarkerMsg.ARROW ? 0f : (float)message.scale.x;
        line.startColor = line.endColor = new Color(message.color.r, message.color.g, message.color.b, message.color.a);
        line.positionCount = message.points.Length;
        for (int i = 0; i < message.points.Length; i++)
            line.SetPosition(i, message.points[i].From<FLU>());
    }

    void OnState(StringMsg message)
    {
        lastState = Time.realtimeSinceStartup;
        if (stateText != null) stateText.text = message.data;
    }
}
