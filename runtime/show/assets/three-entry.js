export {
  Bone, Box3, BufferAttribute, BufferGeometry, CanvasTexture,
  CircleGeometry, Color, DirectionalLight, DoubleSide, Float32BufferAttribute, Group,
  HemisphereLight, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, NeutralToneMapping, Object3D, PCFShadowMap, ShadowMaterial,
  PerspectiveCamera, Quaternion, Ray, REVISION, Scene, Skeleton, SkinnedMesh,
  Vector2, Vector3, Vector4,
  WebGLRenderer,
} from 'three';
export { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
export { Line2 } from 'three/examples/jsm/lines/Line2.js';
export { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
export { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
