function fill = Fill(ply, group, part)
  % A part in a ply of a plane mesh of a dea.Solid, as a struct; several fills are an array of them.
  %
  %   dea.Fill(1, 'electrode', 2)   part 2 in the lowest ply, where the mesh is in that group, a
  %                                 physical surface; '': everywhere
  fill = struct('ply', ply, 'group', char(group), 'part', part);
end
