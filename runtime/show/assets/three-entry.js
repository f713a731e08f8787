export {
  AmbientLight, BoxGeometry, BufferGeometry, CanvasTexture, Color, DirectionalLight, EdgesGeometry,
  Float32BufferAttribute, GridHelper, Group, HemisphereLight, Line, LineBasicMaterial, LineSegments,
  Mesh, MeshBasicMaterial, MeshStandardMaterial, MeshLambertMaterial, PCFShadowMap, PerspectiveCamera,
  PlaneGeometry, Quaternion, Raycaster, Scene, Sprite, SpriteMaterial, Vector2, Vector3,
  WebGLRenderer, Matrix4, REVISION, Fog,
} from 'three';
export { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
