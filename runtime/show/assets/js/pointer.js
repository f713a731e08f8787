// What a ray meets first: the boxes around the parts of objects and fixed things.

const pointer = (trace, scene, model) => {
  const things = scene.parts.flatMap((part) => {
    const { kind, name } = scene.nodes[part.node];
    if (part.layer !== "looks" || (kind !== "object" && kind !== "fixed")) return [];
    const low = new T.Vector3(...part.box), high = low.clone().add(new T.Vector3(...part.box.slice(3)));
    return [{ kind, name, bone: model.bones[part.node], box: new T.Box3(low, high) }];
  });
  const ray = new T.Ray(), inverse = new T.Matrix4(), hit = new T.Vector3();
  return (from, direction) => {
    let best = null, nearest = Infinity;
    for (const thing of things) {
      ray.set(from, direction).applyMatrix4(inverse.copy(thing.bone.matrixWorld).invert());
      if (!ray.intersectBox(thing.box, hit)) continue;
      const distance = hit.applyMatrix4(thing.bone.matrixWorld).distanceTo(from);
      if (distance < nearest) [best, nearest] = [thing, distance];
    }
    return best && { ...best, distance: nearest };
  };
};
